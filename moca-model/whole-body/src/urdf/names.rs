//! Lists of names for error messages.

/// Number of names that an error lists.
const LISTED: usize = 20;

/// Lists the most similar names first, and the number of further ones.
pub(crate) fn nearest<'a>(asked: &str, known: impl Iterator<Item = &'a str>) -> String {
    let mut names: Vec<_> = known.map(|name| (distance(asked, name), name)).collect();
    names.sort_by_key(|(distance, _)| *distance);
    list(names.into_iter().map(|(_, name)| name))
}

/// Lists names in their order, and the number of further ones.
pub(crate) fn list<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let names: Vec<_> = names.collect();
    match names.as_slice() {
        [] => "(none)".to_owned(),
        [shown @ .., _] if shown.len() >= LISTED => {
            let (shown, rest) = names.split_at(LISTED);
            format!("{} and {} more", shown.join(", "), rest.len())
        }
        all => all.join(", "),
    }
}

/// The Levenshtein distance of the first 64 characters, ignoring case.
fn distance(one: &str, other: &str) -> usize {
    let letters =
        |text: &str| -> String { text.chars().take(64).flat_map(char::to_lowercase).collect() };
    strsim::levenshtein(&letters(one), &letters(other))
}

#[cfg(test)]
mod tests {
    use super::{list, nearest};

    #[test]
    fn nearest_name_comes_first_and_lists_are_cut() {
        let known = ["base", "Panda_Hand", "panda_link1"];
        assert_eq!(nearest("panda_hnad", known.into_iter()), "Panda_Hand, panda_link1, base");
        let many: Vec<_> = (0..23).map(|number| number.to_string()).collect();
        assert!(list(many.iter().map(String::as_str)).ends_with("18, 19 and 3 more"));
        assert_eq!(list(std::iter::empty()), "(none)");
    }
}
