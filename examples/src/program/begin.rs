//! The way from the command line to the exit status.

use std::{
    io::{self, Write},
    process::ExitCode,
};

use clap::{CommandFactory, FromArgMatches, Parser};

use super::{
    Ending, Interrupt, Printing, ProgramError, Session, StandardOutput,
    ending::{DONE, FAILURE, HELP, OUTPUT_CLOSED, OUTPUT_FAILED},
    message,
};

/// A program: its options and its work.
pub trait Program: Parser {
    /// Does the work.
    ///
    /// # Errors
    /// The error that ends the program with a message.
    fn run(self, session: &mut Session) -> anyhow::Result<Ending>;
}

/// Runs a program: reads the command line, does the work, and reports by messages on standard error and by the exit
/// status.
pub fn main<P: Program>() -> ExitCode {
    let mut output = StandardOutput::new();
    let status = match parse::<P>() {
        Err(asked) => {
            let status = u8::try_from(asked.exit_code()).unwrap_or(FAILURE);
            let printed = asked.print();
            if asked.use_stderr() {
                return ExitCode::from(status);
            }
            // The output remembers a failure to print the help.
            let _ = output.noted(printed);
            status
        }
        Ok((options, printing)) => match Interrupt::install() {
            Ok(interrupt) => {
                let mut session = Session::new(output, interrupt, printing.is_quiet());
                let result = options.run(&mut session);
                let status = judge(&result, session.interrupt());
                output = session.into_output();
                if let Err(error) = result
                    && output.failure().is_none()
                {
                    message::line(format_args!("error: {}", message::with_causes(&error)));
                }
                status
            }
            Err(error) => {
                message::line(format_args!("error: {error}"));
                FAILURE
            }
        },
    };
    ExitCode::from(end(output).unwrap_or(status))
}

/// Returns the options of a program, and how it prints.
fn parse<P: Parser>() -> Result<(P, Printing), clap::Error> {
    let mut command = <P as CommandFactory>::command().after_help(HELP);
    let matches = command.try_get_matches_from_mut(std::env::args_os())?;
    let mut own = &matches;
    while let Some((_, of_subcommand)) = own.subcommand() {
        own = of_subcommand;
    }
    let options = P::from_arg_matches(&matches).and_then(|options| {
        let printing = Printing::from_arg_matches(own)?;
        Ok((options, printing))
    });
    options.map_err(|error| error.format(&mut command))
}

fn judge(result: &anyhow::Result<Ending>, interrupt: &Interrupt) -> u8 {
    match result {
        Ok(Ending::Complete) => DONE,
        Ok(Ending::Partial) => interrupt.status(),
        Ok(Ending::Failed) => FAILURE,
        Err(error) => {
            let told = |cause: &(dyn std::error::Error + 'static)| {
                matches!(cause.downcast_ref(), Some(ProgramError::Interrupted))
                    || matches!(cause.downcast_ref(), Some(human_perception::Error::Stopped))
            };
            if error.chain().any(told) { interrupt.status() } else { FAILURE }
        }
    }
}

/// Flushes standard output. Returns the exit status if that, or anything before, failed.
fn end(mut output: StandardOutput) -> Option<u8> {
    // The output remembers a failure.
    let _ = output.flush();
    let failure = output.failure()?;
    if failure.kind == io::ErrorKind::BrokenPipe {
        return Some(OUTPUT_CLOSED);
    }
    let error = ProgramError::StandardOutput(failure.message.clone());
    message::line(format_args!("error: {error}"));
    Some(OUTPUT_FAILED)
}
