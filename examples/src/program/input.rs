//! Input of a program: a file, or standard input.

use std::{
    fmt,
    fs::File,
    io::{BufRead, BufReader},
    path::PathBuf,
};

use anyhow::{Context, Result};
use clap::Args;

use super::Session;

/// The option `--input`.
#[derive(Args, Clone, Debug)]
pub struct InputFile {
    /// The table; - is standard input.
    #[arg(long, short, value_name = "FILE")]
    input: PathBuf,
}

impl InputFile {
    /// Opens the input.
    ///
    /// # Errors
    /// The name of a file that cannot be opened; standard input without a thread to read it.
    pub fn open(&self, session: &Session) -> Result<Box<dyn BufRead>> {
        if self.is_standard_input() {
            return Ok(Box::new(session.standard_input()?));
        }
        let file = File::open(&self.input).with_context(|| format!("cannot open {self}"))?;
        Ok(Box::new(BufReader::new(file)))
    }

    fn is_standard_input(&self) -> bool {
        self.input.as_os_str() == "-"
    }
}

/// Shows its name for messages.
impl fmt::Display for InputFile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.is_standard_input() {
            f.write_str("standard input")
        } else {
            self.input.display().fmt(f)
        }
    }
}
