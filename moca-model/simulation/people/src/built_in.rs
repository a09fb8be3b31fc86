//! Motions of real people that are built in.

/// Motions that are built in, with their names.
pub(super) const BUILT_IN: [(&str, &str); 5] = [
    ("walk", include_str!("../motions/walk.jsonl")),
    ("balance", include_str!("../motions/balance.jsonl")),
    ("punch", include_str!("../motions/punch.jsonl")),
    ("dance", include_str!("../motions/dance.jsonl")),
    ("get-up", include_str!("../motions/get-up.jsonl")),
];

/// Their names.
pub(super) const NAMES: [&str; 5] = {
    let [(a, _), (b, _), (c, _), (d, _), (e, _)] = BUILT_IN;
    [a, b, c, d, e]
};
