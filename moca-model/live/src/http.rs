//! The head of a request, and the pages that may ask.

use std::io::{self, Read, Write};
use std::net::{SocketAddr, TcpStream};

use tungstenite::handshake::derive_accept_key;

/// The longest head (bytes), and how many fields it may have.
const LONGEST: usize = 8192;
const FIELDS: usize = 64;

/// Request that was read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Asked {
    pub(crate) path: String,
    /// Value with which a socket is to be accepted; none where a page or file is asked for.
    pub(crate) accept: Option<String>,
    /// Bytes that have come after the head.
    pub(crate) rest: Vec<u8>,
}

/// Reason why a request is refused, as status and text.
pub(crate) type Refusal = (&'static str, &'static str);

const BAD: Refusal = ("400 Bad Request", "this is no request of a browser");
const FOREIGN: Refusal = ("403 Forbidden", "only the page of this program may ask");
const METHOD: Refusal = ("405 Method Not Allowed", "only GET is answered");
pub(crate) const MISSING: Refusal = ("404 Not Found", "there is no such page");
pub(crate) const CROWDED: Refusal = ("503 Service Unavailable", "too many pages are open");

/// Reads the head of a request to a server at an address.
///
/// # Errors
/// Those of the connection; a refusal as the inner error.
pub(crate) fn read(
    stream: &mut impl Read,
    address: SocketAddr,
) -> io::Result<Result<Asked, Refusal>> {
    let (mut bytes, mut block) = (Vec::new(), [0; 1024]);
    loop {
        let count = stream.read(&mut block)?;
        if count == 0 {
            return Ok(Err(BAD));
        }
        bytes.extend(block.iter().take(count));
        let mut fields = [httparse::EMPTY_HEADER; FIELDS];
        let mut head = httparse::Request::new(&mut fields);
        match head.parse(&bytes) {
            Ok(httparse::Status::Complete(length)) => {
                let rest = bytes.get(length..).unwrap_or_default().to_vec();
                return Ok(asked(&head, rest, address));
            }
            Ok(httparse::Status::Partial) if bytes.len() < LONGEST => {}
            _ => return Ok(Err(BAD)),
        }
    }
}

fn asked(
    head: &httparse::Request<'_, '_>,
    rest: Vec<u8>,
    address: SocketAddr,
) -> Result<Asked, Refusal> {
    let all = |name: &'static str| {
        let named = head.headers.iter().filter(move |field| field.name.eq_ignore_ascii_case(name));
        named.map(|field| std::str::from_utf8(field.value).unwrap_or_default())
    };
    let is_own = |host: &str| {
        let port = address.port();
        [format!("127.0.0.1:{port}"), format!("localhost:{port}")].iter().any(|own| own == host)
    };
    // A name that somebody else has made to stand for this machine, and a page of somebody else.
    let mut hosts = all("host");
    let known = hosts.next().is_some_and(is_own) && hosts.next().is_none();
    let mut origins = all("origin");
    if !known || !origins.all(|origin| origin.strip_prefix("http://").is_some_and(is_own)) {
        return Err(FOREIGN);
    }
    if head.method != Some("GET") {
        return Err(METHOD);
    }
    let path = head.path.ok_or(BAD)?.to_owned();
    let is_socket = all("upgrade").any(|to| to.eq_ignore_ascii_case("websocket"));
    let accept = if is_socket {
        let is_spoken = all("sec-websocket-version").any(|version| version == "13");
        let key = all("sec-websocket-key").next().filter(|_| is_spoken).ok_or(BAD)?;
        Some(derive_accept_key(key.as_bytes()))
    } else {
        None
    };
    Ok(Asked { path, accept, rest })
}

/// Refuses a request.
///
/// # Errors
/// Those of the connection.
pub(crate) fn refuse(stream: &mut TcpStream, (status, text): Refusal) -> io::Result<()> {
    answer(stream, status, "text/plain; charset=utf-8", "", text.as_bytes())
}

/// Answers with a body; `fields` are whole lines.
///
/// # Errors
/// Those of the connection.
pub(crate) fn answer(
    stream: &mut impl Write,
    status: &str,
    kind: &str,
    fields: &str,
    body: &[u8],
) -> io::Result<()> {
    let length = body.len();
    write!(
        stream,
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {length}\r\nConnection: close\r\n\
         Cache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\nX-Frame-Options: DENY\r\n{fields}\r\n"
    )?;
    stream.write_all(body)?;
    stream.flush()
}

/// Accepts a socket.
///
/// # Errors
/// Those of the connection.
pub(crate) fn accept(stream: &mut impl Write, key: &str) -> io::Result<()> {
    write!(
        stream,
        "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n\
         Sec-WebSocket-Accept: {key}\r\n\r\n"
    )?;
    stream.flush()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ask(head: &str) -> Result<Asked, Refusal> {
        let address = SocketAddr::from(([127, 0, 0, 1], 8000));
        read(&mut head.as_bytes(), address).unwrap()
    }

    #[test]
    fn the_page_itself_may_ask() {
        let page = ask("GET / HTTP/1.1\r\nHost: 127.0.0.1:8000\r\n\r\n").unwrap();
        assert_eq!((&*page.path, &page.accept), ("/", &None));
        let socket = ask(
            "GET /live HTTP/1.1\r\nHost: localhost:8000\r\nOrigin: http://localhost:8000\r\n\
             Upgrade: WebSocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\nxy",
        );
        let socket = socket.unwrap();
        // RFC 6455, section 1.3.
        assert_eq!(socket.accept.as_deref(), Some("s3pPLMBiTxaQ9kYGzzhZRbK+xOo="));
        assert_eq!(socket.rest, b"xy");
    }

    #[test]
    fn others_are_refused() {
        let long = format!("GET /{} HTTP/1.1\r\n", "x".repeat(2 * LONGEST));
        for (head, refusal) in [
            ("GET / HTTP/1.1\r\n\r\n", FOREIGN),
            ("GET / HTTP/1.1\r\nHost: evil.example\r\n\r\n", FOREIGN),
            ("GET / HTTP/1.1\r\nHost: 127.0.0.1:8000\r\nHost: evil.example\r\n\r\n", FOREIGN),
            ("GET / HTTP/1.1\r\nHost: 127.0.0.1:8001\r\n\r\n", FOREIGN),
            (
                "GET /live HTTP/1.1\r\nHost: 127.0.0.1:8000\r\nOrigin: http://evil.example\r\n\r\n",
                FOREIGN,
            ),
            ("GET /live HTTP/1.1\r\nHost: 127.0.0.1:8000\r\nOrigin: null\r\n\r\n", FOREIGN),
            ("POST / HTTP/1.1\r\nHost: 127.0.0.1:8000\r\n\r\n", METHOD),
            ("GET /live HTTP/1.1\r\nHost: 127.0.0.1:8000\r\nUpgrade: websocket\r\n\r\n", BAD),
            ("\u{1}\u{2}\r\n\r\n", BAD),
            ("GET / HTTP/1.1\r\nHost: 127", BAD),
            (&long, BAD),
        ] {
            assert_eq!(ask(head), Err(refusal), "{head:.60}");
        }
    }
}
