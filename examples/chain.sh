#!/bin/sh
# Closes the chain from pixels to the controller on simulated people: films with their truth, a surface and an action
# recogniser trained on some of them, and on others what is perceived, against the truth, and what the robot does.
#
#   sh examples/chain.sh FOLDER [PROGRAMS] [full|short]
#
# FOLDER is made, and holds everything. PROGRAMS is the folder of the built programs (target/release). `full` takes
# about five minutes of processor time; `short` shows in seconds that everything fits together, and measures nothing.
# Options of `follow` may be given in the variable FOLLOW, as --map FILE.
set -eu

[ $# -ge 1 ] || { sed -n '2,9s/^# \{0,1\}//p' "$0" >&2; exit 2; }
folder=$1
programs=${2:-target/release}
case ${3:-full} in
full)
    training='1 2 3 4' test='101 102' perceived='101 102'
    film='--size 128x128' pixels=0.6
    surface='--depth 18' images='--every 20' looks=10
    network='--network slowonly_r18_mm --length 8 --interval 2 --side 96'
    clips='--length 15 --every 8 --settled 8'
    head='--epochs 60 --learning-rate 0.01 --dropout 0.2 --standardise'
    ;;
short)
    training='1 2' test='101 102' perceived='101'
    film='--size 32x32 --duration 5.5' pixels=0.2
    surface='--depth 18 --no-flips' images='--every 8' looks=20
    network='--network slowonly_r18_mm --length 2 --interval 2 --side 32'
    clips='--length 3 --every 10'
    head='--epochs 5 --standardise'
    ;;
*)
    echo "chain.sh: \"$3\": give full or short" >&2
    exit 2
    ;;
esac

mkdir "$folder"

# run NAME PROGRAM ARGUMENTS...: what it prints goes to FOLDER/NAME.txt.
run() {
    output=$folder/$1.txt program=$2
    shift 2
    "$programs/$program" "$@" --quiet >"$output" || { echo "chain.sh: $program failed" >&2; exit 1; }
}

# The folders of the films of these seeds; every other person has a polisher, and all differ in stature.
films() {
    for seed in "$@"; do
        name=$folder/film$seed
        if [ ! -d "$name" ]; then
            [ $((seed % 2)) -eq 1 ] && tool=drill || tool=polisher
            # shellcheck disable=SC2086
            run "film$seed" record --frames "$name" --seed "$seed" --tool "$tool" \
                --stature "1.$((62 + seed * 7 % 23))" $film
        fi
        echo "$name"
    done
}

# shellcheck disable=SC2086
{
    trained=$(films $training)
    others=$(films $test)

    run surface-images surface cut $trained --output "$folder/surfaces" $images
    run surface-train surface train "$folder/surfaces" --output "$folder/surface" \
        --random-backbone 1 $surface $head --cache "$folder/cache"
    run surface-others surface cut $others --output "$folder/other-surfaces" $images
    run surface-evaluate surface evaluate "$folder/other-surfaces" --model "$folder/surface" --part all \
        --output "$folder/surface-report"
    tail -n 3 "$folder/surface-evaluate.txt"

    run action-clips actions cut $trained --output "$folder/clips" $clips
    run action-train actions train "$folder/clips" --output "$folder/action" --split 2 \
        --random-backbone 1 $network $head --no-flips --cache "$folder/cache"
    run action-others actions cut $others --output "$folder/other-clips" $clips
    run action-evaluate actions evaluate "$folder/other-clips" --model "$folder/action" --part all \
        --clips 1 --crops centre --output "$folder/action-report"
    tail -n 1 "$folder/action-evaluate.txt"

    for seed in $perceived; do
        run "perceive$seed" perceive "$folder/film$seed" --skeletons "$folder/film$seed/skeletons" \
            --surface-model "$folder/surface" --surface-interval "$looks" \
            --action-model "$folder/action" --pixel-sigma "$pixels" \
            --truth "$folder/film$seed/truth.jsonl" --output "$folder/perceived$seed.jsonl"
        echo "film $seed, $(grep '^against the truth' "$folder/perceive$seed.txt")"
        run "follow$seed" follow --recording "$folder/perceived$seed.jsonl" --no-report ${FOLLOW:-}
        cat "$folder/follow$seed.txt"
    done
}
