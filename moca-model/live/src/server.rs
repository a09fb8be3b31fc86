//! The page and its socket, on loopback alone.

use std::io;
use std::net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::sync_channel;
use std::thread;
use std::time::Duration;

use moca_simulation::workcell::Memory;

use crate::desk::{Desk, Order};
use crate::error::Error;
use crate::{http, page, socket};

/// Largest number of connections at a time.
const CONNECTIONS: usize = 16;
/// A request that takes longer to come is given up.
const PATIENCE: Duration = Duration::from_secs(3);
/// Interval between checks for the end.
const TURN: Duration = Duration::from_millis(20);

/// Serves pages until the loop has ended.
///
/// Only this machine is listened to; requests of other pages are refused, by their `Origin` and `Host`.
#[derive(Debug)]
pub struct Server {
    listener: TcpListener,
    address: SocketAddr,
    desk: Arc<Desk>,
}

impl Server {
    /// Listens on a port of 127.0.0.1; on any that is free for 0.
    ///
    /// # Errors
    /// [`Error::Listen`].
    pub fn bind(port: u16, desk: Arc<Desk>) -> Result<Self, Error> {
        let wanted = SocketAddr::from((Ipv4Addr::LOCALHOST, port));
        let fail = |source| Error::Listen { address: wanted.to_string(), source };
        let listener = TcpListener::bind(wanted).map_err(fail)?;
        listener.set_nonblocking(true).map_err(fail)?;
        let address = listener.local_addr().map_err(fail)?;
        Ok(Self { listener, address, desk })
    }

    /// Address of the page.
    pub fn address(&self) -> String {
        format!("http://{}/", self.address)
    }

    /// Serves until the loop has ended.
    pub fn serve(&self) {
        let open = AtomicUsize::new(0);
        thread::scope(|scope| {
            while !self.desk.has_ended() {
                let Ok((stream, _)) = self.listener.accept() else {
                    thread::sleep(TURN);
                    continue;
                };
                let crowded = open.fetch_add(1, Ordering::AcqRel) >= CONNECTIONS;
                let open = &open;
                scope.spawn(move || {
                    // A connection that breaks off is nobody's loss.
                    let _ = self.connection(stream, crowded);
                    open.fetch_sub(1, Ordering::AcqRel);
                });
            }
        });
    }

    fn connection(&self, mut stream: TcpStream, crowded: bool) -> io::Result<()> {
        stream.set_nonblocking(false)?;
        stream.set_read_timeout(Some(PATIENCE))?;
        stream.set_write_timeout(Some(PATIENCE))?;
        let asked = match http::read(&mut stream, self.address)? {
            Ok(_) if crowded => return http::refuse(&mut stream, http::CROWDED),
            Ok(asked) => asked,
            Err(refusal) => return http::refuse(&mut stream, refusal),
        };
        match (&*asked.path, asked.accept) {
            ("/live", Some(key)) => {
                http::accept(&mut stream, &key)?;
                socket::serve(stream, asked.rest, &self.desk).map_err(io::Error::other)
            }
            ("/", None) => {
                let fields = page::fields(self.address);
                let html = page::html();
                let kind = "text/html; charset=utf-8";
                http::answer(&mut stream, "200 OK", kind, &fields, html.as_bytes())
            }
            ("/recording.jsonl", None) => self.file(&mut stream, "live.jsonl", |memory| {
                memory.write_recording(Vec::new()).map_err(io::Error::other)
            }),
            ("/truth.jsonl", None) => self.file(&mut stream, "live-truth.jsonl", |memory| {
                memory.write_truth(Vec::new()).map_err(io::Error::other)
            }),
            ("/settings.toml", None) => {
                let text = self.desk.head().settings.clone();
                download(&mut stream, "live.toml", text.as_bytes())
            }
            _ => http::refuse(&mut stream, http::MISSING),
        }
    }

    /// Writes what has happened to a file.
    fn file(
        &self,
        stream: &mut TcpStream,
        name: &str,
        write: impl FnOnce(&Memory) -> io::Result<Vec<u8>>,
    ) -> io::Result<()> {
        let (sender, receiver) = sync_channel(1);
        self.desk.order(Order::Remember(sender)).map_err(io::Error::other)?;
        let memory = receiver.recv_timeout(PATIENCE).map_err(io::Error::other)?;
        download(stream, name, &write(&memory)?)
    }
}

fn download(stream: &mut TcpStream, name: &str, bytes: &[u8]) -> io::Result<()> {
    let fields = format!("Content-Disposition: attachment; filename=\"{name}\"\r\n");
    http::answer(stream, "200 OK", "application/octet-stream", &fields, bytes)
}
