//! Label files: the classes of a network, and the classes of a data set's clips.

use std::{fs, path::Path, str::FromStr};

use crate::{Action, Error};

/// The largest label file that is read (bytes).
const MAX_BYTES: u64 = 64 << 20;

/// The names of a network's classes, in the order of its scores.
///
/// A file has a name a line, with or without a number before it (`1 Deliver Object`,
/// `0,Deliver Object`); the numbers must follow each other. Copies of HRI30 differ in their order,
/// so the file that came with the weights counts.
///
/// ```
/// use vision_models::{Action, ClassNames};
///
/// let names: ClassNames = "1 WalkingWithObject\n2 Deliver_Object\n".parse()?;
/// assert_eq!(names.actions()?, [Action::WalkingWithObject, Action::DeliverObject]);
/// assert_eq!(names.index("2"), Some(1));
/// # Ok::<(), vision_models::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ClassNames {
    names: Vec<String>,
    /// The number of the first class in the file.
    first: usize,
}

impl ClassNames {
    /// HRI30's, in the order of [`Action::ALL`].
    pub fn hri30() -> Self {
        Self { names: Action::ALL.iter().map(|action| action.name().into()).collect(), first: 0 }
    }

    /// Reads a file.
    ///
    /// # Errors
    /// [`Error::File`], [`Error::Labels`].
    pub fn read(path: impl AsRef<Path>) -> Result<Self, Error> {
        read_text(path.as_ref())?.parse()
    }

    /// The names.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// The class of a name, however its words are joined, or of a number as the file has it.
    pub fn index(&self, label: &str) -> Option<usize> {
        let by_name = self.names.iter().position(|name| is_same(name, label));
        let by_number = || {
            label
                .parse::<usize>()
                .ok()?
                .checked_sub(self.first)
                .filter(|&index| index < self.names.len())
        };
        by_name.or_else(by_number)
    }

    /// The classes as actions of HRI30.
    ///
    /// # Errors
    /// [`Error::UnknownAction`] for a name that is none.
    pub fn actions(&self) -> Result<Vec<Action>, Error> {
        self.names
            .iter()
            .map(|name| {
                Action::ALL
                    .into_iter()
                    .find(|action| is_same(action.name(), name))
                    .ok_or_else(|| Error::UnknownAction { name: name.clone() })
            })
            .collect()
    }

    /// Reads the classes of clips: a line each, its name and then its class, by name or number,
    /// with a comma or a space between. A first line whose class is unknown is a heading.
    ///
    /// # Errors
    /// [`Error::Labels`].
    pub fn clips(&self, text: &str) -> Result<Vec<(String, usize)>, Error> {
        let mut clips = Vec::new();
        for (line, number) in lines(text) {
            let parts = line.rsplit_once(',').or_else(|| line.split_once([' ', '\t']));
            let labelled = parts.and_then(|(clip, label)| {
                Some((clip.trim().to_owned(), self.index(label.trim())?))
            });
            match labelled {
                Some(labelled) => clips.push(labelled),
                None if number == 1 => {}
                None => {
                    let expected = "a clip's name, a comma or a space, and a class of the list";
                    return Err(Error::Labels { line: number, expected });
                }
            }
        }
        Ok(clips)
    }
}

impl FromStr for ClassNames {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        let mut classes = Self { names: Vec::new(), first: 0 };
        let mut numbered = None;
        for (line, at) in lines(text) {
            let (number, name) = split_number(line);
            let refuse = |expected| Error::Labels { line: at, expected };
            if name.is_empty() {
                return Err(refuse("a class name"));
            }
            if *numbered.get_or_insert(number.is_some()) != number.is_some() {
                return Err(refuse("a number before every class name or before none"));
            }
            if let Some(number) = number {
                if classes.names.is_empty() {
                    classes.first = number;
                }
                if number.checked_sub(classes.first) != Some(classes.names.len()) {
                    return Err(refuse("numbers that follow each other"));
                }
            }
            classes.names.push(name.into());
        }
        let mut keys: Vec<String> = classes.names.iter().map(|name| key(name)).collect();
        keys.sort_unstable();
        if keys.is_empty() || keys.windows(2).any(|pair| pair[0] == pair[1]) {
            let expected = "at least one class name, and each once";
            return Err(Error::Labels { line: lines(text).count().max(1), expected });
        }
        Ok(classes)
    }
}

/// The lines that are not empty, trimmed, counted from one.
fn lines(text: &str) -> impl Iterator<Item = (&str, usize)> {
    text.lines().map(str::trim).zip(1..).filter(|(line, _)| !line.is_empty())
}

/// A number at the start, if something stands between it and the name.
fn split_number(line: &str) -> (Option<usize>, &str) {
    let split = line.split_once([' ', '\t', ',', ':']);
    match split.map(|(number, name)| (number.parse(), name)) {
        Some((Ok(number), name)) => (Some(number), name.trim()),
        _ => (None, line),
    }
}

fn is_same(one: &str, other: &str) -> bool {
    letters(one).eq(letters(other))
}

fn key(name: &str) -> String {
    letters(name).collect()
}

/// What names are compared by: letters and digits, in lower case.
fn letters(name: &str) -> impl Iterator<Item = char> {
    name.chars().filter(|letter| letter.is_alphanumeric()).flat_map(char::to_lowercase)
}

fn read_text(path: &Path) -> Result<String, Error> {
    let refuse = |reason: String| Error::File { path: path.display().to_string(), reason };
    let length = fs::metadata(path).map_err(|error| refuse(error.to_string()))?.len();
    if length > MAX_BYTES {
        return Err(refuse(format!("{length} bytes are too many for a label file")));
    }
    fs::read_to_string(path).map_err(|error| refuse(error.to_string()))
}
