//! Pages at a loop that runs in real time.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs)]

use std::io::{Read, Write};
use std::net::TcpStream;
use std::sync::{Arc, LazyLock, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use ergo_map::{ErgonomicsMap, MapOptions, Person};
use moca_live::moca_simulation::workcell::{Setup, Workcell};
use moca_live::whole_body::control_loop::{
    ControlLoop, JointMeasurement, LoopSettings, MonotonicClock,
};
use moca_live::{Desk, Law, Server, SettingsText, Within};
use percept_recording::{IfPartial, Reader, Recording};
use serde_json::Value;
use tungstenite::{Message, WebSocket};

/// A program with its page.
struct Program {
    address: String,
    desk: Arc<Desk>,
    threads: Vec<JoinHandle<()>>,
    _alone: MutexGuard<'static, ()>,
}

impl Program {
    fn start() -> Self {
        // One at a time: each is to keep up with real time.
        static ALONE: Mutex<()> = Mutex::new(());
        static SETUP: LazyLock<Setup> = LazyLock::new(|| {
            let coarse = MapOptions { spacing: 0.1, ..MapOptions::default() };
            let map = ErgonomicsMap::build(&Person::average(), &coarse, None).unwrap();
            Setup::new(map).unwrap()
        });
        let alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
        let mut cell = Workcell::new(SETUP.clone()).unwrap();
        cell.welcome().unwrap();
        let text = SettingsText {
            write: |settings| Ok(format!("goal = {:?}", settings.controller.goal)),
            read: |text, settings| match text {
                "same" => Ok(settings.clone()),
                _ => Err("line 1: there is no setting".to_owned()),
            },
        };
        let (mut law, desk) = Law::new(cell, text).unwrap();
        let server = Server::bind(0, Arc::clone(&desk)).unwrap();
        let address = server.address();
        let address = address.trim_start_matches("http://").trim_end_matches('/').to_owned();
        let shared = Arc::clone(&desk);
        let looping = thread::spawn(move || {
            let model = law.cell().plant().controller().robot().model().clone();
            let measured = JointMeasurement::at_rest(&model);
            let mut control = ControlLoop::new(LoopSettings::default(), measured).unwrap();
            let mut clock = MonotonicClock::default();
            control.run(&mut Within, &mut law, &mut clock, || shared.has_ended()).unwrap();
        });
        let serving = thread::spawn(move || server.serve());
        Self { address, desk, threads: vec![looping, serving], _alone: alone }
    }

    fn page(&self) -> Page {
        let stream = TcpStream::connect(&self.address).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(20))).unwrap();
        let address = format!("ws://{}/live", self.address);
        let (socket, _) = tungstenite::client(address, stream).unwrap();
        Page { socket }
    }

    fn ask(&self, path: &str) -> String {
        let mut stream = TcpStream::connect(&self.address).unwrap();
        write!(stream, "GET {path} HTTP/1.1\r\nHost: {}\r\n\r\n", self.address).unwrap();
        let mut answer = String::new();
        stream.read_to_string(&mut answer).unwrap();
        answer
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        self.desk.end();
        for thread in self.threads.drain(..) {
            thread.join().unwrap();
        }
    }
}

struct Page {
    socket: WebSocket<TcpStream>,
}

impl Page {
    fn say(&mut self, text: &str) {
        self.socket.send(Message::text(text)).unwrap();
    }

    /// The next message of a kind; pictures are acknowledged.
    fn next(&mut self, kind: &str) -> Value {
        loop {
            let Message::Text(text) = self.socket.read().unwrap() else { continue };
            let message: Value = serde_json::from_str(&text).unwrap();
            if message["kind"] == "picture" {
                self.say(r#"{"do": "drawn", "picture": 1}"#);
            }
            if message["kind"] == kind {
                return message;
            }
        }
    }

    fn floor(&mut self) -> [f64; 2] {
        let picture = self.next("picture");
        [0, 1].map(|axis| picture["floor"][axis].as_f64().unwrap())
    }
}

#[test]
fn the_person_goes_where_the_page_says() {
    let program = Program::start();
    let mut page = program.page();
    assert_eq!(page.next("role")["steers"], true);
    let hello = page.next("hello");
    assert!(hello["page"]["runs"][0]["solids"].as_array().unwrap().len() > 10);
    page.say(r#"{"do": "lead", "way": {"to": [2.6, 0.5]}, "speed": 1.0, "activity": "walk"}"#);
    let begun = Instant::now();
    loop {
        let [x, y] = page.floor();
        if (x - 2.6).hypot(y - 0.5) < 0.05 {
            break;
        }
        assert!(begun.elapsed() < Duration::from_secs(20), "at {x}, {y}");
    }
    let saved = program.ask("/recording.jsonl");
    let (head, body) = saved.split_once("\r\n\r\n").unwrap();
    assert!(head.starts_with("HTTP/1.1 200"), "{head}");
    let recording = Recording::read(Reader::new(body.as_bytes()).unwrap(), IfPartial::Refuse);
    assert!(recording.unwrap().percepts.len() > 5);
    assert!(program.ask("/settings.toml").ends_with("goal = Ergonomics"));
    assert!(program.ask("/other").starts_with("HTTP/1.1 404"));
    assert!(program.ask("/").contains("<title>MOCA, live</title>"));
}

#[test]
fn bad_messages_are_answered_and_move_nothing() {
    let program = Program::start();
    let mut page = program.page();
    page.say(r#"{"do": "lead", "way": "stand"}"#);
    let before = loop {
        let picture = page.next("picture");
        if picture["heard"] == 1 {
            thread::sleep(Duration::from_millis(1500));
            break page.floor();
        }
    };
    for bad in ["", "{", r#"{"do": "lead", "speed": 7}"#, r#"{"do": "restart", "settings": "x"}"#] {
        page.say(bad);
        let error = page.next("error");
        assert!(!error["error"].as_str().unwrap().is_empty(), "{error}");
    }
    page.socket.send(Message::binary(vec![0; 64])).unwrap();
    page.next("error");
    page.say(r#"{"do": "lead", "who": "bystander", "way": {"to": [0, 0]}}"#);
    // Pictures that were on their way are older.
    (0..4).for_each(|_| drop(page.next("picture")));
    let after = page.floor();
    assert!((before[0] - after[0]).hypot(before[1] - after[1]) < 0.02, "{before:?} {after:?}");
    page.say(r#"{"do": "restart", "stature": 1.6, "settings": "same"}"#);
    assert_eq!(page.next("hello")["stature"], 1.6);
}

#[test]
fn one_steers_until_it_leaves() {
    let program = Program::start();
    let mut first = program.page();
    assert_eq!(first.next("role")["steers"], true);
    let mut second = program.page();
    assert_eq!(second.next("role")["steers"], false);
    second.say(r#"{"do": "stop"}"#);
    let error = second.next("error");
    assert!(error["error"].as_str().unwrap().contains("another page steers"), "{error}");
    drop(first);
    assert_eq!(second.next("role")["steers"], true);
}

#[test]
fn a_page_that_reads_nothing_slows_nothing() {
    let program = Program::start();
    let mut reader = program.page();
    // It says no more than that it is there.
    let _silent = program.page();
    let ticks = |page: &mut Page| page.next("picture")["pace"]["ticks"].as_u64().unwrap();
    let (before, begun) = (ticks(&mut reader), Instant::now());
    while begun.elapsed() < Duration::from_secs(2) {
        ticks(&mut reader);
    }
    let made = ticks(&mut reader) - before;
    let due = begun.elapsed().as_millis();
    assert!(u128::from(made) * 2 > due, "{made} ticks in {due} ms");
}
