//! Columns: their names, the kind of their cells, and their place on the sheet.

use std::fmt;

/// Kind of the cells of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cell {
    /// An angle in degrees, from -180 to 180, which is converted to radians.
    Angle,
    /// A mass in kilograms, from 0 to 1000.
    Load,
    /// 0 or 1, or a spreadsheet's TRUE or FALSE; an empty cell is 0.
    Flag,
    /// One of these words, or its index from 0.
    Choice(&'static [&'static str]),
    /// A rating from 0 to 20.
    Rating,
    /// The number of times that one of six scales was chosen over another: an integer from 0 to 5.
    Tally,
    /// A nonempty name.
    Name,
}

/// A column of a table of sheets `S`.
pub struct Column<S> {
    /// Name of the column.
    pub name: &'static str,
    /// Kind of its cells.
    pub cell: Cell,
    /// True if a table must have the column. A missing column counts as 0.
    pub needed: bool,
    set: Set<S>,
}

/// TRUE and FALSE as written by spreadsheets in English, German, French, Italian and Spanish.
const TRUTHS: [(&str, f64); 10] = [
    ("true", 1.0),
    ("wahr", 1.0),
    ("vrai", 1.0),
    ("vero", 1.0),
    ("verdadero", 1.0),
    ("false", 0.0),
    ("falsch", 0.0),
    ("faux", 0.0),
    ("falso", 0.0),
    ("", 0.0),
];

/// Format of the numbers of a table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Numbers {
    /// True if a comma may precede the decimals, as in a table with another cell separator.
    pub(super) decimal_comma: bool,
    /// End of the scales of ratings.
    pub(super) ratings_end: f64,
}

/// End of the scales of ratings on a sheet.
pub(super) const RATINGS_END: f64 = 20.0;

/// Setter of a cell's value on the sheet.
enum Set<S> {
    Number(fn(&mut S, f64)),
    Text(fn(&mut S, &str)),
}

impl<S> Column<S> {
    /// Creates a column that every table must have.
    pub(crate) const fn needed(name: &'static str, cell: Cell, set: fn(&mut S, f64)) -> Self {
        Self { name, cell, needed: true, set: Set::Number(set) }
    }

    /// Creates a column that a table may leave out.
    pub(crate) const fn optional(name: &'static str, cell: Cell, set: fn(&mut S, f64)) -> Self {
        Self { name, cell, needed: false, set: Set::Number(set) }
    }

    /// Creates a column of names.
    pub(crate) const fn name(name: &'static str, needed: bool, set: fn(&mut S, &str)) -> Self {
        Self { name, cell: Cell::Name, needed, set: Set::Text(set) }
    }

    /// Creates a column of tick boxes.
    pub(crate) const fn flag(name: &'static str, set: fn(&mut S, f64)) -> Self {
        Self::optional(name, Cell::Flag, set)
    }

    /// Sets a cell on the sheet. The error is the kind of value that the cell should have.
    pub(super) fn fill(&self, sheet: &mut S, cell: &str, numbers: Numbers) -> Result<(), Cell> {
        match self.set {
            Set::Number(set) => set(sheet, self.cell.value(cell, numbers).ok_or(self.cell)?),
            Set::Text(_) if cell.is_empty() => return Err(self.cell),
            Set::Text(set) => set(sheet, cell),
        }
        Ok(())
    }
}

impl<S> fmt::Debug for Column<S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, cell, needed, set: _ } = self;
        f.debug_struct("Column")
            .field("name", name)
            .field("cell", cell)
            .field("needed", needed)
            .finish_non_exhaustive()
    }
}

impl Cell {
    /// Returns the number of a cell, angles in radians and ratings from 0 to 20. `None` if the cell
    /// is invalid.
    fn value(self, cell: &str, numbers: Numbers) -> Option<f64> {
        let number = match cell.split_once(',') {
            Some((whole, decimals)) if numbers.decimal_comma => {
                format!("{whole}.{decimals}").parse::<f64>().ok()
            }
            _ => cell.parse::<f64>().ok(),
        };
        let within = |min: f64, max: f64| number.filter(|x| (min..=max).contains(x));
        match self {
            Self::Angle => within(-180.0, 180.0).map(f64::to_radians),
            Self::Load => within(0.0, 1000.0),
            Self::Flag => {
                let truth = TRUTHS.iter().find(|(word, _)| word.eq_ignore_ascii_case(cell));
                truth.map(|(_, value)| *value).or(number.filter(|x| *x == 0.0 || *x == 1.0))
            }
            Self::Choice(words) => {
                let named = words.iter().position(|word| word.eq_ignore_ascii_case(cell));
                let index =
                    number.filter(|x| x.fract() == 0.0 && (0.0..words.len() as f64).contains(x));
                named.map(|index| index as f64).or(index)
            }
            Self::Rating => {
                let end = numbers.ratings_end;
                within(0.0, end).map(|rating| rating * RATINGS_END / end)
            }
            Self::Tally => within(0.0, 5.0).filter(|x| x.fract() == 0.0),
            Self::Name => None,
        }
    }
}

impl fmt::Display for Cell {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Angle => write!(f, "an angle from -180 to 180 degrees, such as 12.5"),
            Self::Load => write!(f, "a load from 0 to 1000 kg, such as 2.5"),
            Self::Flag => write!(f, "1 for yes, or 0 (or nothing) for no"),
            Self::Choice(words) => {
                let numbered: Vec<_> =
                    words.iter().enumerate().map(|(i, word)| format!("{i} ({word})")).collect();
                write!(f, "one of {}", numbered.join(", "))
            }
            Self::Rating => write!(f, "a rating from 0 to 20"),
            Self::Tally => write!(f, "how often this scale was chosen, a whole number from 0 to 5"),
            Self::Name => write!(f, "a name"),
        }
    }
}
