//! Programs that are run as processes.

use std::fs::File;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::mpsc::channel;
use std::thread;
use std::time::Duration;

use super::coarse_map_file;

/// Longest time that a test waits for a program.
const PATIENCE: Duration = Duration::from_secs(120);

/// A program with its arguments.
pub(crate) struct Runs {
    name: &'static str,
    command: Command,
}

/// The result of a program's run.
#[derive(Debug)]
pub(crate) struct Ran {
    pub(crate) status: ExitStatus,
    pub(crate) output: String,
    pub(crate) errors: String,
}

impl Runs {
    /// Creates a run of the program of this name. It always has RUST_BACKTRACE=1, since no message may depend on it.
    pub(crate) fn new(name: &'static str) -> Self {
        let folder = Path::new(env!("CARGO_BIN_EXE_record")).parent().unwrap();
        let mut command =
            Command::new(folder.join(name).with_extension(std::env::consts::EXE_EXTENSION));
        command.env("RUST_BACKTRACE", "1");
        Self { name, command }
    }

    /// Creates a run of `follow` with a coarse map, which takes less time than building one.
    pub(crate) fn follow() -> Self {
        Self::new("follow").with(&["--map", coarse_map_file()])
    }

    /// Creates a run of the program of this name with at most this memory (MiB). Addresses count, not used memory.
    pub(crate) fn within(name: &'static str, mebibytes: u32) -> Self {
        let Self { command: program, .. } = Self::new(name);
        let mut command = Command::new("sh");
        let limit = format!("ulimit -v {}; exec \"$0\" \"$@\"", mebibytes * 1024);
        command.env("RUST_BACKTRACE", "1").args(["-c", &limit]).arg(program.get_program());
        Self { name, command }
    }

    pub(crate) fn with<A: AsRef<std::ffi::OsStr>>(mut self, arguments: &[A]) -> Self {
        self.command.args(arguments);
        self
    }

    /// Looks for other programs in this folder alone.
    pub(crate) fn with_programs_in(mut self, folder: &Path) -> Self {
        self.command.env("PATH", folder);
        self
    }

    /// Puts it on the ROS 2 graph of this domain.
    #[cfg(feature = "ros2")]
    pub(crate) fn on_domain(mut self, domain: u16) -> Self {
        self.command.env("ROS_DOMAIN_ID", domain.to_string());
        self
    }

    /// Runs it to its end.
    pub(crate) fn run(self) -> Ran {
        self.run_on("")
    }

    /// Runs it to its end with a standard error on a full device. Returns its exit status.
    pub(crate) fn code_with_full_errors(mut self) -> Option<i32> {
        let full = File::options().write(true).open("/dev/full").unwrap();
        let status = self.command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(full).status();
        status.unwrap().code()
    }

    /// Runs it to its end with this on standard input.
    pub(crate) fn run_on(mut self, input: &str) -> Ran {
        self.command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = self.command.spawn().unwrap();
        let mut stdin = child.stdin.take().unwrap();
        let input = input.to_owned();
        // A program that stops early does not read the rest.
        let writer = thread::spawn(move || drop(stdin.write_all(input.as_bytes())));
        let output = child.wait_with_output().unwrap();
        writer.join().unwrap();
        Ran {
            status: output.status,
            output: String::from_utf8(output.stdout).unwrap(),
            errors: String::from_utf8(output.stderr).unwrap(),
        }
    }

    /// Runs it with a closed standard output.
    pub(crate) fn run_closed(mut self) -> Ran {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        self.command.stdin(Stdio::null()).stdout(writer).stderr(Stdio::piped());
        let child = self.command.spawn().unwrap();
        Ran::of(child)
    }

    /// Runs it with a standard output on a full device.
    pub(crate) fn run_full(mut self) -> Ran {
        let full = File::options().write(true).open("/dev/full").unwrap();
        self.command.stdin(Stdio::null()).stdout(full).stderr(Stdio::piped());
        let child = self.command.spawn().unwrap();
        Ran::of(child)
    }

    /// Runs it, sends it a signal as soon as a line on standard error contains `sign`, and waits for its end.
    pub(crate) fn interrupt_at(mut self, sign: &str, signal: &str) -> Ran {
        self.command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = self.command.spawn().unwrap();
        let lines = BufReader::new(child.stderr.take().unwrap()).lines();
        let (sender, receiver) = channel();
        thread::spawn(move || lines.map_while(Result::ok).for_each(|line| drop(sender.send(line))));
        let mut errors = String::new();
        while !errors.contains(sign) {
            let Ok(line) = receiver.recv_timeout(PATIENCE) else {
                child.kill().unwrap();
                panic!("{} did not say {sign:?}: {errors}", self.name);
            };
            errors.extend([line.as_str(), "\n"]);
        }
        self::signal(&child, signal);
        let mut ran = Ran::of(child);
        for line in receiver {
            errors.extend([line.as_str(), "\n"]);
        }
        ran.errors = errors;
        ran
    }

    /// Starts it with pipes for all standard streams.
    pub(crate) fn start(mut self) -> Child {
        self.command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        self.command.spawn().unwrap()
    }
}

impl Ran {
    pub(crate) fn of(child: Child) -> Self {
        let output = child.wait_with_output().unwrap();
        Self {
            status: output.status,
            output: String::from_utf8(output.stdout).unwrap(),
            errors: String::from_utf8(output.stderr).unwrap(),
        }
    }

    /// The exit status; `None` if a signal ended the program.
    pub(crate) fn code(&self) -> Option<i32> {
        self.status.code()
    }

    /// The JSON object on the last line.
    pub(crate) fn json(&self) -> serde_json::Value {
        serde_json::from_str(self.output.lines().last().unwrap()).unwrap()
    }

    /// Asserts that the program succeeded.
    pub(crate) fn done(self) -> Self {
        assert_eq!(self.code(), Some(0), "{self:?}");
        self
    }

    /// Asserts that it failed with this status and one short message that contains `says` and no internal details.
    pub(crate) fn failed(self, code: i32, says: &str) -> Self {
        assert_eq!(self.code(), Some(code), "{self:?}");
        assert!(self.errors.contains(says), "no {says:?} in {self:?}");
        assert!(self.errors.len() < 2000, "a message of {} bytes", self.errors.len());
        for insides in ["panicked", "backtrace", "Stack", "src/", "::"] {
            assert!(!self.errors.contains(insides), "{insides} in {self:?}");
        }
        self
    }
}

/// Sends a signal to a program, such as `INT`.
pub(crate) fn signal(child: &Child, signal: &str) {
    let kill = Command::new("kill").args([&format!("-{signal}"), &child.id().to_string()]).status();
    assert!(kill.unwrap().success());
}
