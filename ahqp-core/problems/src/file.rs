//! Sets of hierarchical problems as text. The book describes the format in `hqp-format.md`.
//!
//! ```
//! use hqp_problems::file::HqpReader;
//!
//! let text = "hqpset tiny 1\nproblem 0 first 2 1\nlevel G 0 1\n1 1 2 2\n";
//! let problem = HqpReader::new(text.as_bytes())?.next().ok_or("no problem")??;
//! assert_eq!(problem.hierarchy.variables(), 2);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod error;
mod reason;
mod tokens;

use std::io::BufRead;

use ahqp_core::{Hierarchy, Level, Rows};

pub use error::HqpError;
use tokens::{Number, Tokens};

/// Bounds of at least this size count as infinite.
pub const INFINITE: f64 = 1e30;
/// Largest number of variables of a problem.
pub const MOST_VARIABLES: usize = 4096;
/// Largest number of coefficients (rows × variables) of all rows of a problem.
pub const MOST_COEFFICIENTS: usize = 1 << 26;

/// One problem of a set.
#[derive(Debug, Clone, PartialEq)]
pub struct Problem {
    /// INDEX in the file.
    pub index: usize,
    /// NAME in the file.
    pub name: String,
    /// The hierarchy.
    pub hierarchy: Hierarchy,
    /// Lines of its levels in the file.
    lines: Lines,
}

/// Lines on which the levels of a problem begin.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
struct Lines {
    /// Line of the level that became the bounds of the variables.
    bounds: Option<usize>,
    /// Line of each level of the hierarchy.
    levels: Vec<usize>,
}

/// Reads the problems of a set one by one, from text that is not kept in memory.
///
/// Memory grows with the data read, not with the counts in the file. The iterator ends after an
/// error.
#[derive(Debug)]
pub struct HqpReader<R> {
    tokens: Tokens<R>,
    name: String,
    count: usize,
    read: usize,
    done: bool,
}

impl<R: BufRead> HqpReader<R> {
    /// Reads the header `hqpset NAME COUNT`.
    ///
    /// # Errors
    /// [`HqpError`] if the header is invalid.
    pub fn new(input: R) -> Result<Self, HqpError> {
        let mut tokens = Tokens::new(input);
        tokens.keyword("hqpset", "the file")?;
        let name = tokens.word("the NAME of the set")?;
        let count = tokens.count("the COUNT of problems")?;
        Ok(Self { tokens, name, count, read: 0, done: false })
    }

    /// Name of the set.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Number of problems according to the header.
    pub fn count(&self) -> usize {
        self.count
    }

    fn problem(&mut self) -> Result<Problem, HqpError> {
        let tokens = &mut self.tokens;
        tokens.keyword("problem", "a problem")?;
        let index = tokens.count("the INDEX of the problem")?;
        let name = tokens.word("the NAME of the problem")?;
        let variables = tokens.count_up_to("the number of variables", 1, MOST_VARIABLES)?;
        let levels = tokens.count("the number of levels")?;
        let mut builder = Builder::new(variables)?;
        for level in 0..levels {
            builder.level(level, tokens)?;
        }
        Ok(Problem { index, name, hierarchy: builder.hierarchy, lines: builder.lines })
    }
}

impl<R: BufRead> Iterator for HqpReader<R> {
    type Item = Result<Problem, HqpError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.done {
            return None;
        }
        let result = if self.read < self.count {
            self.read += 1;
            Some(self.problem())
        } else {
            self.done = true;
            self.tokens.end("the problems that the header counts").err().map(Err)
        };
        self.done |= matches!(result, Some(Err(_)));
        result
    }
}

/// Kind of rows of a level.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// One variable for each row.
    Bounds,
    /// General rows, with all variables.
    General,
}

/// One row of a level of bounds.
struct Bound {
    variable: usize,
    lower: f64,
    upper: f64,
}

/// Builds one hierarchy from the tokens of its levels.
struct Builder {
    hierarchy: Hierarchy,
    lines: Lines,
    coefficients: usize,
}

impl Builder {
    fn new(variables: usize) -> Result<Self, HqpError> {
        let hierarchy = Hierarchy::new(variables)?;
        Ok(Self { hierarchy, lines: Lines::default(), coefficients: 0 })
    }

    fn level<R: BufRead>(&mut self, level: usize, tokens: &mut Tokens<R>) -> Result<(), HqpError> {
        tokens.keyword("level", "a level")?;
        let line = tokens.line();
        let kind = tokens.choice("KIND", [("B", Kind::Bounds), ("G", Kind::General)])?;
        let hard = tokens.choice("HARD", [("0", false), ("1", true)])?;
        let count = tokens.count("the number of rows")?;
        let rows = match kind {
            Kind::General => self.general(count, tokens)?,
            Kind::Bounds => {
                let bounds = self.bounds(count, tokens)?;
                if level == 0 && hard && self.set_bounds(&bounds) {
                    self.lines.bounds = Some(line);
                    return Ok(());
                }
                self.unit_rows(&bounds)?
            }
        };
        self.hierarchy.push(if hard {
            Level::constraints_only(rows)
        } else {
            Level::least_squares(rows)
        })?;
        self.lines.levels.push(line);
        Ok(())
    }

    /// Counts one more row, and checks that there is room for it.
    fn expect_room<R>(&mut self, tokens: &Tokens<R>) -> Result<(), HqpError> {
        self.coefficients += self.hierarchy.variables();
        if self.coefficients > MOST_COEFFICIENTS {
            return Err(HqpError::Value {
                line: tokens.line(),
                what: "the number of coefficients of a problem",
                got: self.coefficients.to_string(),
                wanted: format!("at most {MOST_COEFFICIENTS}"),
            });
        }
        Ok(())
    }

    fn general<R: BufRead>(
        &mut self,
        count: usize,
        tokens: &mut Tokens<R>,
    ) -> Result<Rows, HqpError> {
        let n = self.hierarchy.variables();
        let (mut matrix, mut lower, mut upper) = (Vec::new(), Vec::new(), Vec::new());
        for _ in 0..count {
            self.expect_room(tokens)?;
            for _ in 0..n {
                matrix.push(tokens.number("a coefficient", Number::Finite)?);
            }
            lower.push(tokens.number("a lower bound", Number::Bound)?);
            upper.push(tokens.number("an upper bound", Number::Bound)?);
        }
        Ok(Rows::from_row_slice(count, n, &matrix, &lower, &upper)?)
    }

    fn bounds<R: BufRead>(
        &mut self,
        count: usize,
        tokens: &mut Tokens<R>,
    ) -> Result<Vec<Bound>, HqpError> {
        let last = self.hierarchy.variables() - 1;
        let mut bounds = Vec::new();
        for _ in 0..count {
            self.expect_room(tokens)?;
            bounds.push(Bound {
                variable: tokens.count_up_to("the variable of a bound", 0, last)?,
                lower: tokens.number("a lower bound", Number::Bound)?,
                upper: tokens.number("an upper bound", Number::Bound)?,
            });
        }
        Ok(bounds)
    }

    /// Takes the first level's bounds as those of the variables. Returns false and changes nothing
    /// if a variable has several.
    fn set_bounds(&mut self, bounds: &[Bound]) -> bool {
        let mut seen = vec![false; self.hierarchy.variables()];
        if bounds.iter().any(|bound| std::mem::replace(&mut seen[bound.variable], true)) {
            return false;
        }
        let (lower, upper) = self.hierarchy.bounds_mut();
        for bound in bounds {
            (lower[bound.variable], upper[bound.variable]) = (bound.lower, bound.upper);
        }
        true
    }

    fn unit_rows(&self, bounds: &[Bound]) -> Result<Rows, HqpError> {
        let mut rows = Rows::zeros(bounds.len(), self.hierarchy.variables());
        for (i, bound) in bounds.iter().enumerate() {
            rows.row_mut(i)?[bound.variable] = 1.0;
            (rows.lower_mut()[i], rows.upper_mut()[i]) = (bound.lower, bound.upper);
        }
        Ok(rows)
    }
}
