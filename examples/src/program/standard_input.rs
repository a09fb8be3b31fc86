//! Standard input that an interrupt ends.

use std::{
    io::{self, BufRead, Read, stdin},
    sync::mpsc::{Receiver, RecvTimeoutError, sync_channel},
    thread,
    time::Duration,
};

use super::{Interrupt, ProgramError};

/// Largest number of bytes that are read at once.
const CHUNK: usize = 64 * 1024;
/// Time in which an interrupt is noticed while nothing comes.
const PATIENCE: Duration = Duration::from_millis(20);

/// Standard input. Reading fails once an interrupt has come, so that nobody waits for a next line for ever.
#[derive(Debug)]
pub struct StandardInput {
    chunks: Receiver<io::Result<Vec<u8>>>,
    interrupt: Interrupt,
    chunk: Vec<u8>,
    used: usize,
}

impl StandardInput {
    pub(super) fn new(interrupt: Interrupt) -> Result<Self, ProgramError> {
        let (sender, chunks) = sync_channel(1);
        let read = move || {
            loop {
                let mut chunk = vec![0; CHUNK];
                let read = stdin().lock().read(&mut chunk);
                chunk.truncate(*read.as_ref().unwrap_or(&0));
                let over = chunk.is_empty();
                // Nobody listens when the program has read enough.
                if sender.send(read.map(|_| chunk)).is_err() || over {
                    return;
                }
            }
        };
        thread::Builder::new()
            .spawn(read)
            .map_err(|source| ProgramError::Refused { what: "another thread", source })?;
        Ok(Self { chunks, interrupt, chunk: Vec::new(), used: 0 })
    }
}

impl BufRead for StandardInput {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        while self.used == self.chunk.len() {
            match self.chunks.recv_timeout(PATIENCE) {
                Ok(chunk) => (self.chunk, self.used) = (chunk?, 0),
                Err(RecvTimeoutError::Timeout) => {
                    self.interrupt.check().map_err(io::Error::other)?;
                }
                Err(RecvTimeoutError::Disconnected) => break,
            }
        }
        Ok(self.chunk.get(self.used..).unwrap_or_default())
    }

    fn consume(&mut self, amount: usize) {
        self.used = self.chunk.len().min(self.used + amount);
    }
}

impl Read for StandardInput {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = self.fill_buf()?.read(buffer)?;
        self.consume(read);
        Ok(read)
    }
}
