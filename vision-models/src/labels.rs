//! Label files: the classes of a network, and the classes of a data set's clips.

use std::{
    collections::{BTreeMap, btree_map::Entry},
    path::Path,
    str::FromStr,
};

use crate::action::{Action, unknown};
use crate::error::Error;
use crate::excerpt::Excerpt;
use crate::file::{in_file, read_text, without_byte_order_mark};

/// Largest label file that is read (bytes).
const MAX_BYTES: u64 = 64 << 20;
/// Largest number of classes. No network has more.
pub(crate) const MAX_CLASSES: usize = 100_000;

/// The names of a network's classes, in the order of its scores.
///
/// A file has one name per line, with or without a number before it (`1 Deliver Object`,
/// `0,Deliver Object`). The numbers must be consecutive. Copies of HRI30 differ in their order, so
/// use the file that came with the weights. At most 100,000 names are read.
///
/// Names are compared by their letters and digits, including case: ImageNet has a dog `Cardigan`
/// and a jacket `cardigan`. [`Self::index`] ignores case if only one class then matches. Classes
/// with the same name, such as the two `crane` of ImageNet, differ only in their number, which
/// [`Self::label`] shows.
///
/// ```
/// use vision_models::{Action, ClassNames};
///
/// let names: ClassNames = "1 WalkingWithObject\n2 Deliver_Object\n".parse()?;
/// assert_eq!(names.actions()?, [Action::WalkingWithObject, Action::DeliverObject]);
/// assert_eq!(names.index("deliver object"), Some(1));
/// assert_eq!(names.index("2"), Some(1));
/// # Ok::<(), vision_models::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ClassNames {
    names: Vec<String>,
    /// The number of the first class in the file.
    first: usize,
    /// The classes of each name, by the name's letters.
    by_letters: BTreeMap<String, Named>,
    /// The classes by the name's letters in lower case, or `None` if several names become equal.
    by_lower_case: BTreeMap<String, Option<usize>>,
}

/// The classes of one name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Named {
    first: usize,
    /// True if another class has the same name.
    is_shared: bool,
}

impl ClassNames {
    /// Returns HRI30's classes, in the order of [`Action::ALL`].
    pub fn hri30() -> Self {
        let mut classes = Self::numbered_from(0);
        for action in Action::ALL {
            let letters = letters(action.name());
            classes.insert(action.name().into(), letters);
        }
        classes
    }

    /// Reads a file of at most 64 MiB.
    ///
    /// # Errors
    /// [`Error::File`] if it cannot be read, [`Error::Malformed`] if its lines are wrong.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, Error> {
        let path = path.as_ref();
        read_text(path, MAX_BYTES).map_err(in_file(path))?.parse()
    }

    /// Returns the names.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Returns the name of a class for display. If another class has the same name, the class's
    /// number from zero is added. `None` for a class without a name.
    ///
    /// ```
    /// use vision_models::ClassNames;
    ///
    /// let names: ClassNames = "crane\nheron\ncrane\n".parse()?;
    /// assert_eq!(names.label(1).as_deref(), Some("heron"));
    /// assert_eq!(names.label(2).as_deref(), Some("crane (2)"));
    /// # Ok::<(), vision_models::Error>(())
    /// ```
    pub fn label(&self, class: usize) -> Option<String> {
        let name = self.names.get(class)?;
        let is_shared = self.by_letters.get(&letters(name)).is_some_and(|named| named.is_shared);
        Some(if is_shared { format!("{name} ({class})") } else { name.clone() })
    }

    /// Returns the class of a name, however its words are joined, or of a number in the file. Case
    /// only matters if names differ in nothing else. `None` if several classes have the name.
    pub fn index(&self, label: &str) -> Option<usize> {
        let letters = letters(label);
        let by_number = || {
            let index = label.parse::<usize>().ok()?.checked_sub(self.first)?;
            (index < self.names.len()).then_some(index)
        };
        self.by_letters
            .get(&letters)
            .and_then(|named| (!named.is_shared).then_some(named.first))
            .or_else(|| self.by_lower_case.get(&letters.to_lowercase()).copied().flatten())
            .or_else(by_number)
    }

    /// Returns the classes as actions of HRI30.
    ///
    /// # Errors
    /// [`Error::Name`] if a name is not an action.
    pub fn actions(&self) -> Result<Vec<Action>, Error> {
        let key = |name: &str| letters(name).to_lowercase();
        let known = Action::ALL.map(|action| (key(action.name()), action));
        self.names
            .iter()
            .map(|name| {
                let key = key(name);
                let action = known.iter().find(|(known, _)| *known == key);
                action.map(|&(_, action)| action).ok_or_else(|| unknown(name))
            })
            .collect()
    }

    /// Reads a file of at most 64 MiB as [`Self::clips`] does.
    ///
    /// # Errors
    /// [`Error::File`] if it cannot be read, [`Error::Malformed`] if its lines are wrong.
    pub fn read_clips(&self, path: impl AsRef<Path>) -> Result<Vec<(String, usize)>, Error> {
        let path = path.as_ref();
        self.clips(&read_text(path, MAX_BYTES).map_err(in_file(path))?)
    }

    /// Reads the classes of clips, one per line: the clip's name and its class, by name or number,
    /// separated by a comma or a space. A first line with an unknown class is a heading.
    ///
    /// # Errors
    /// [`Error::Malformed`] if a line is wrong.
    pub fn clips(&self, text: &str) -> Result<Vec<(String, usize)>, Error> {
        let mut clips = Vec::new();
        for (line, number) in lines(without_byte_order_mark(text)) {
            let parts = line.rsplit_once(',').or_else(|| line.split_once([' ', '\t']));
            let labelled = parts.and_then(|(clip, label)| {
                Some((clip.trim().to_owned(), self.index(label.trim())?))
            });
            match labelled {
                Some(labelled) => clips.push(labelled),
                None if number == 1 => {}
                None => {
                    let expected = "a clip's name, a comma or a space, and a class of the list";
                    return Err(refuse(number, expected));
                }
            }
        }
        Ok(clips)
    }

    fn numbered_from(first: usize) -> Self {
        let (by_letters, by_lower_case) = (BTreeMap::new(), BTreeMap::new());
        Self { names: Vec::new(), first, by_letters, by_lower_case }
    }

    /// Adds the next class. Returns the class whose name differs only in its spelling, if there is
    /// one.
    fn insert(&mut self, name: String, letters: String) -> Option<usize> {
        let class = self.names.len();
        match self.by_lower_case.entry(letters.to_lowercase()) {
            Entry::Vacant(place) => {
                place.insert(Some(class));
            }
            Entry::Occupied(mut place) => {
                place.insert(None);
            }
        }
        let other = match self.by_letters.entry(letters) {
            Entry::Vacant(place) => {
                place.insert(Named { first: class, is_shared: false });
                None
            }
            Entry::Occupied(mut place) => {
                place.get_mut().is_shared = true;
                Some(place.get().first)
            }
        };
        let other = other.filter(|&other| self.names.get(other) != Some(&name));
        self.names.push(name);
        other
    }
}

impl FromStr for ClassNames {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        let mut classes: Option<Self> = None;
        let mut numbered = None;
        let mut at_lines = Vec::new();
        for (line, at) in lines(without_byte_order_mark(text)) {
            let (number, name) = split_number(line);
            let refuse = |expected| Err(refuse(at, expected));
            if name.is_empty() {
                return refuse("a class name");
            }
            if *numbered.get_or_insert(number.is_some()) != number.is_some() {
                return refuse("a number before every class name or before none");
            }
            let classes = classes.get_or_insert_with(|| Self::numbered_from(number.unwrap_or(0)));
            let class = classes.names.len();
            if number.is_some_and(|number| number.checked_sub(classes.first) != Some(class)) {
                return refuse("numbers that follow each other");
            }
            if class == MAX_CLASSES {
                return refuse("at most 100,000 class names");
            }
            at_lines.push(at);
            if let Some(other) = classes.insert(name.into(), letters(name)) {
                let problem = format!(
                    "\"{}\" and \"{}\" are one name, as only letters and digits count: give each \
                     class its own",
                    Excerpt(&classes.names[other]),
                    Excerpt(name)
                );
                let lines = format!("label file, lines {} and {at}", at_lines[other]);
                return Err(Error::malformed(&lines, problem));
            }
        }
        classes.ok_or_else(|| refuse(1, "at least one class name"))
    }
}

/// Returns the error of a line, counted from one.
fn refuse(line: usize, expected: &str) -> Error {
    Error::malformed(&format!("label file, line {line}"), format!("expected {expected}"))
}

/// Returns the lines that are not empty, trimmed, with their numbers from one.
fn lines(text: &str) -> impl Iterator<Item = (&str, usize)> {
    text.lines().map(str::trim).zip(1..).filter(|(line, _)| !line.is_empty())
}

/// Splits a number at the start from the name, if a separator stands between them.
fn split_number(line: &str) -> (Option<usize>, &str) {
    let split = line.split_once([' ', '\t', ',', ':']);
    match split.map(|(number, name)| (number.parse(), name)) {
        Some((Ok(number), name)) => (Some(number), name.trim()),
        _ => (None, line),
    }
}

/// Returns the characters by which names are compared: letters and digits, or all of a name that
/// has neither.
fn letters(name: &str) -> String {
    let letters: String = name.chars().filter(|letter| letter.is_alphanumeric()).collect();
    if letters.is_empty() { name.into() } else { letters }
}
