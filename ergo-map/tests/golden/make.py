#!/usr/bin/env python3
"""Golden values for REBA and RULA, from an implementation that is independent of the crate.

The tables are typed as the printed sheets arrange them (REBA: Hignett & McAtamney, Applied
Ergonomics 31, 2000; RULA: McAtamney & Corlett, Applied Ergonomics 24, 1993). Run in this folder:
python3 make.py. Writes reba_combinations.csv, reba_sheets.csv, rula_arm.csv, rula_body.csv,
rula_grand.csv and rula_sheets.csv.
"""
import csv
import itertools
import random

# Rows: trunk 1-5; groups: neck 1-3; digits: legs 1-4.
REBA_A = ["1234 1234 3356", "2345 3456 4567", "2456 4567 5678", "3567 5678 6789", "4678 6789 7899"]
# Rows: upper arm 1-6; groups: lower arm 1-2; digits: wrist 1-3.
REBA_B = ["122 123", "123 234", "345 455", "455 567", "678 788", "788 899"]
# Rows: score A 1-12; digits (base 13): score B 1-12.
REBA_C = [
    "111233456777", "122344566778", "233345677888", "344456788999", "444567889999", "66678899aaaa",
    "7778999aabbb", "8889aaaaabbb", "999aaabbbccc", "aaabbbbccccc", "bbbbcccccccc",
    "cccccccccccc",
]
# Rows: upper arm 1-6 and lower arm 1-3; groups: wrist 1-4; digits: twist 1-2.
RULA_A = [
    "12 22 23 33", "22 22 33 33", "23 33 33 44",
    "23 33 34 44", "33 33 34 44", "34 44 44 55",
    "33 44 44 55", "34 44 44 55", "44 44 45 55",
    "44 44 45 55", "44 44 45 55", "44 45 55 66",
    "55 55 56 67", "56 66 67 77", "66 67 77 78",
    "77 77 78 89", "88 88 89 99", "99 99 99 99",
]
# Rows: neck 1-6; groups: trunk 1-6; digits: legs 1-2.
RULA_B = [
    "13 23 34 55 66 77", "23 23 45 55 67 77", "33 34 45 56 67 77", "55 56 67 77 77 88",
    "77 77 78 88 88 88", "88 88 88 89 99 99",
]
# Rows: arm score 1-8; digits: body score 1-7.
RULA_C = ["1233455", "2234455", "3334456", "3334566", "4445677", "4456677", "5566777", "5567777"]


def digit(text):
    return int(text, 13)


def reba_a(neck, trunk, legs):
    return digit(REBA_A[trunk - 1].split()[neck - 1][legs - 1])


def reba_b(upper, lower, wrist):
    return digit(REBA_B[upper - 1].split()[lower - 1][wrist - 1])


def reba_c(a, b):
    return digit(REBA_C[a - 1][b - 1])


def reba_action(score):
    return next(level for level, top in enumerate((1, 3, 7, 10, 15)) if score <= top)


def rula_action(score):
    return 1 if score <= 2 else 2 if score <= 4 else 3 if score <= 6 else 4


def reba_parts(r):
    """Sub-scores of a sheet (angles in degrees, boxes 0 or 1)."""
    t = r["trunk_flex_deg"]
    if abs(t) <= 5:
        trunk = 1
    elif abs(t) <= 20:
        trunk = 2
    elif t < 0 or t <= 60:
        trunk = 3
    else:
        trunk = 4
    neck = 1 if 0 <= r["neck_flex_deg"] <= 20 else 2
    legs = 2 if r["unilateral"] else 1
    legs += (r["knee_flex_deg"] > 30) + (r["knee_flex_deg"] > 60)
    u = r["upper_arm_flex_deg"]
    upper = 1 if -20 <= u <= 20 else 2 if u <= 45 else 3 if u <= 90 else 4
    upper += r["arm_abducted_or_rotated"] + r["shoulder_raised"] - r["arm_supported"]
    lower = 1 if 60 <= r["lower_arm_flex_deg"] <= 100 else 2
    wrist = 1 if abs(r["wrist_flex_deg"]) <= 15 else 2
    return (
        neck + r["neck_twist_or_side"], trunk + r["trunk_twist_or_side"], legs, max(upper, 1), lower,
        wrist + r["wrist_dev_or_twist"],
    )


def reba_sheet(r):
    neck, trunk, legs, upper, lower, wrist = parts = reba_parts(r)
    table_a, table_b = reba_a(neck, trunk, legs), reba_b(upper, lower, wrist)
    load = 0 if r["load_kg"] < 5 else 1 if r["load_kg"] <= 10 else 2
    score_a, score_b = table_a + load + r["shock"], table_b + r["coupling"]
    score_c = reba_c(score_a, score_b)
    score = score_c + r["static"] + r["repeated"] + r["rapid_or_unstable"]
    return (*parts, table_a, score_a, table_b, score_b, score_c, score, reba_action(score))


REBA_ANGLES = {
    "trunk_flex_deg": (-40, 110, (-20, -5, 0, 5, 20, 60)),
    "neck_flex_deg": (-45, 60, (0, 20)),
    "knee_flex_deg": (0, 130, (30, 60)),
    "upper_arm_flex_deg": (-60, 180, (-20, 0, 20, 45, 90)),
    "lower_arm_flex_deg": (0, 150, (60, 100)),
    "wrist_flex_deg": (-75, 80, (-15, 15)),
}
REBA_BOXES = (
    "trunk_twist_or_side", "neck_twist_or_side", "unilateral", "arm_abducted_or_rotated",
    "shoulder_raised", "arm_supported", "wrist_dev_or_twist", "shock", "static", "repeated",
    "rapid_or_unstable",
)
REBA_OUT = (
    "s_neck", "s_trunk", "s_legs", "s_upper_arm", "s_lower_arm", "s_wrist", "table_a", "score_a",
    "table_b", "score_b", "score_c", "reba", "action_level",
)


def angle(draw, low, high, marks):
    """A random angle; one in five lies exactly on a threshold."""
    return draw.choice(marks) if draw.random() < 0.2 else round(draw.uniform(low, high), 3)


def reba_row(draw):
    row = {name: angle(draw, *limits) for name, limits in REBA_ANGLES.items()}
    row["load_kg"] = draw.choice((0, 3, 4.999, 5, 7.5, 10, 10.001, 20))
    row["coupling"] = draw.randrange(4)
    row.update({name: draw.randrange(2) for name in REBA_BOXES})
    return row


RULA_ANGLES = {
    "upper_arm_flex_deg": (-60, 180, (-20, 0, 20, 45, 90)),
    "lower_arm_flex_deg": (0, 150, (60, 100)),
    "wrist_flex_deg": (-75, 80, (-15, -5, 0, 5, 15)),
    "neck_flex_deg": (-45, 60, (0, 10, 20)),
    "trunk_flex_deg": (-40, 110, (-20, -5, 0, 5, 20, 60)),
}
RULA_BOXES = (
    "shoulder_raised", "arm_abducted", "arm_supported", "arm_across_or_out", "wrist_deviated",
    "wrist_twisted", "neck_twisted", "neck_bent", "trunk_twisted", "trunk_bent",
    "legs_unsupported", "muscle_use",
)
RULA_OUT = (
    "s_upper_arm", "s_lower_arm", "s_wrist", "s_wrist_twist", "s_neck", "s_trunk", "s_legs",
    "table_a", "score_a", "table_b", "score_b", "rula", "action_level",
)


def rula_a(upper, lower, wrist, twist):
    return digit(RULA_A[3 * (upper - 1) + lower - 1].split()[wrist - 1][twist - 1])


def rula_b(neck, trunk, legs):
    return digit(RULA_B[neck - 1].split()[trunk - 1][legs - 1])


def rula_c(a, b):
    return digit(RULA_C[min(a, 8) - 1][min(b, 7) - 1])


def rula_sheet(r):
    u = r["upper_arm_flex_deg"]
    upper = 1 if -20 <= u <= 20 else 2 if u <= 45 else 3 if u <= 90 else 4
    upper += r["shoulder_raised"] + r["arm_abducted"] - r["arm_supported"]
    lower = (1 if 60 <= r["lower_arm_flex_deg"] <= 100 else 2) + r["arm_across_or_out"]
    w = abs(r["wrist_flex_deg"])
    wrist = (1 if w <= 5 else 2 if w <= 15 else 3) + r["wrist_deviated"]
    n = r["neck_flex_deg"]
    neck = 4 if n < 0 else 1 if n <= 10 else 2 if n <= 20 else 3
    neck += r["neck_twisted"] + r["neck_bent"]
    t = r["trunk_flex_deg"]
    trunk = 1 if abs(t) <= 5 else 2 if abs(t) <= 20 else 3 if t <= 60 else 4
    trunk += r["trunk_twisted"] + r["trunk_bent"]
    parts = max(upper, 1), lower, wrist, 1 + r["wrist_twisted"], neck, trunk, 1 + r["legs_unsupported"]
    kg, pattern = r["load_kg"], r["load_pattern"]
    if pattern == "shock":
        load = 3
    elif kg < 2:
        load = 0
    else:
        load = 1 + (kg > 10) + (pattern == "static_or_repeated")
    extra = load + r["muscle_use"]
    table_a, table_b = rula_a(*parts[:4]), rula_b(*parts[4:])
    score = rula_c(table_a + extra, table_b + extra)
    return (*parts, table_a, table_a + extra, table_b, table_b + extra, score, rula_action(score))


def rula_row(draw):
    row = {name: angle(draw, *limits) for name, limits in RULA_ANGLES.items()}
    row["load_kg"] = draw.choice((0, 1.999, 2, 5, 10, 10.001, 20))
    row["load_pattern"] = draw.choice(("intermittent", "static_or_repeated", "shock"))
    row.update({name: draw.randrange(2) for name in RULA_BOXES})
    return row


def write(name, header, rows):
    with open(name, "w", newline="") as file:
        out = csv.writer(file, lineterminator="\n")
        out.writerow(header)
        out.writerows(rows)


def main():
    parts = ("neck", "trunk", "legs", "upper_arm", "lower_arm", "wrist")
    combinations = []
    for n, t, l, u, o, w in itertools.product(*(range(1, k + 1) for k in (3, 5, 4, 6, 2, 3))):
        a, b = reba_a(n, t, l), reba_b(u, o, w)
        c = reba_c(a, b)
        combinations.append((n, t, l, u, o, w, a, b, c, reba_action(c)))
    write("reba_combinations.csv", (*parts, "a", "b", "reba", "action_level"), combinations)

    draw = random.Random(2000)
    sheets = [reba_row(draw) for _ in range(1500)]
    write(
        "reba_sheets.csv", (*sheets[0], *REBA_OUT), [(*r.values(), *reba_sheet(r)) for r in sheets]
    )

    arm = itertools.product(*(range(1, k + 1) for k in (6, 3, 4, 2)))
    write("rula_arm.csv", ("upper_arm", "lower_arm", "wrist", "wrist_twist", "a"),
          [(*p, rula_a(*p)) for p in arm])
    body = itertools.product(*(range(1, k + 1) for k in (6, 6, 2)))
    write("rula_body.csv", ("neck", "trunk", "legs", "b"), [(*p, rula_b(*p)) for p in body])
    # One combination of sub-scores for every cell of table C.
    cells = {}
    sizes = (6, 3, 4, 2, 6, 6, 2)
    draw = random.Random(1992)
    while len(cells) < 56:
        # Powers of a uniform number, since low sub-scores would otherwise be rare.
        ease = draw.choice((1, 3, 6))
        p = tuple(1 + int(draw.random() ** ease * k) for k in sizes)
        extra = draw.randrange(5)
        a, b = rula_a(*p[:4]) + extra, rula_b(*p[4:]) + extra
        cells.setdefault((min(a, 8), min(b, 7)), (*p, extra, rula_c(a, b)))
    header = ("upper_arm", "lower_arm", "wrist", "wrist_twist", "neck", "trunk", "legs", "extra", "rula")
    write("rula_grand.csv", header, sorted(cells.values()))
    draw = random.Random(1993)
    sheets = [rula_row(draw) for _ in range(1500)]
    write(
        "rula_sheets.csv", (*sheets[0], *RULA_OUT), [(*r.values(), *rula_sheet(r)) for r in sheets]
    )


if __name__ == "__main__":
    main()
