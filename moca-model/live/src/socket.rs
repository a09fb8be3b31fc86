//! One page: its messages, and pictures for it.

use std::io;
use std::net::TcpStream;
use std::time::Duration;

use moca_simulation::workcell::Workcell;
use serde::Serialize;
use tungstenite::protocol::{Role, WebSocketConfig};
use tungstenite::{Message, WebSocket};

use crate::desk::{Desk, Order};
use crate::error::Error;
use crate::head::sampler;
use crate::request::{Request, Restart};

/// The longest message of a page (bytes): ten times a file with all settings.
const LONGEST: usize = 1 << 20;
/// Interval between looks at a silent page.
const TURN: Duration = Duration::from_millis(4);
/// A page that takes longer for a message is given up.
const PATIENCE: Duration = Duration::from_secs(5);
/// Largest number of pictures on their way to a page, which says when it has drawn one.
const ON_THEIR_WAY: u64 = 2;

#[derive(Serialize)]
struct Refused {
    kind: &'static str,
    error: String,
    /// The message that it is about, counted from 1.
    message: u64,
}

/// Steering state of a page.
#[derive(Serialize)]
struct Steering {
    kind: &'static str,
    steers: bool,
}

/// A page with its socket.
struct Page<'a> {
    socket: WebSocket<TcpStream>,
    desk: &'a Desk,
    number: u64,
    /// Messages so far.
    messages: u64,
    /// Pictures sent and drawn.
    sent: u64,
    drawn: u64,
    /// The newest picture that was sent, and the head.
    shown: u64,
    head: u64,
    steers: Option<bool>,
}

/// Serves a page until it leaves or the loop has ended; `rest` has come after the head of its request.
///
/// # Errors
/// Those of the connection.
pub(crate) fn serve(
    stream: TcpStream,
    rest: Vec<u8>,
    desk: &Desk,
) -> Result<(), tungstenite::Error> {
    stream.set_read_timeout(Some(TURN))?;
    stream.set_write_timeout(Some(PATIENCE))?;
    stream.set_nodelay(true)?;
    let config = WebSocketConfig::default()
        .max_message_size(Some(LONGEST))
        .max_frame_size(Some(LONGEST))
        .max_write_buffer_size(4 * LONGEST);
    let socket = WebSocket::from_partially_read(stream, rest, Role::Server, Some(config));
    let number = desk.enter();
    let mut page = Page {
        socket,
        desk,
        number,
        messages: 0,
        sent: 0,
        drawn: 0,
        shown: 0,
        head: 0,
        steers: None,
    };
    let ended = page.go_on();
    desk.leave(number);
    ended
}

impl Page<'_> {
    fn go_on(&mut self) -> Result<(), tungstenite::Error> {
        while !self.desk.has_ended() {
            self.look()?;
            match self.socket.read() {
                Ok(Message::Text(text)) => self.hear(&text)?,
                Ok(Message::Binary(_)) => {
                    self.messages += 1;
                    self.refuse(&Error::Request { reason: "give text".to_owned() })?;
                }
                Ok(Message::Close(_)) | Err(tungstenite::Error::ConnectionClosed) => return Ok(()),
                Ok(_) => {}
                Err(tungstenite::Error::Io(error)) if is_pause(&error) => {}
                Err(error) => return Err(error),
            }
        }
        self.socket.close(None)?;
        Ok(())
    }

    /// Sends what is new to the page.
    fn look(&mut self) -> Result<(), tungstenite::Error> {
        let steers = self.desk.steers(self.number);
        if self.steers != Some(steers) {
            self.steers = Some(steers);
            self.send(&Steering { kind: "role", steers })?;
        }
        if self.sent >= self.drawn + ON_THEIR_WAY {
            return Ok(());
        }
        let Some(picture) = self.desk.newest() else { return Ok(()) };
        let head = self.desk.head();
        if self.head != head.number {
            self.head = head.number;
            self.socket.send(Message::text(head.json()))?;
        }
        if picture.number > self.shown && picture.head == self.head {
            self.shown = picture.number;
            self.sent += 1;
            self.send(&*picture)?;
        }
        Ok(())
    }

    fn send(&mut self, message: &impl Serialize) -> Result<(), tungstenite::Error> {
        let text = serde_json::to_string(message).map_err(io::Error::from)?;
        self.socket.send(Message::text(text))
    }

    fn refuse(&mut self, error: &Error) -> Result<(), tungstenite::Error> {
        let message = self.messages;
        self.send(&Refused { kind: "error", error: error.to_string(), message })
    }

    fn hear(&mut self, text: &str) -> Result<(), tungstenite::Error> {
        self.messages += 1;
        match Request::read(text).and_then(|request| self.obey(request)) {
            Ok(()) => Ok(()),
            Err(error) => self.refuse(&error),
        }
    }

    fn obey(&mut self, request: Request) -> Result<(), Error> {
        if let Request::Drawn(_) = request {
            self.drawn = (self.drawn + 1).min(self.sent);
            return Ok(());
        }
        if !self.desk.steers(self.number) {
            return Err(Error::Watching);
        }
        match request {
            Request::Restart(restart) => self.restart(&restart),
            request => self.desk.order(Order::Request(request, self.messages)),
        }
    }

    /// Another workcell in place of this one; it is made here, so that the loop goes on meanwhile.
    fn restart(&self, restart: &Restart) -> Result<(), Error> {
        let before = self.desk.head();
        let setup = before.restarted(restart)?;
        let mut cell = Workcell::new(setup)?;
        cell.welcome()?;
        let sampler = sampler(&cell)?;
        let head = before.next(cell.setup(), &sampler)?;
        let number = head.number;
        self.desk.order(Order::Replace(Box::new((cell, sampler)), number))?;
        self.desk.set_head(head);
        Ok(())
    }
}

/// Nothing has come in time.
fn is_pause(error: &io::Error) -> bool {
    matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut)
}
