//! Progress and messages of a library's long work.

use std::ops::ControlFlow;

use human_perception::Event;

use super::{Progress, Session};

impl Session {
    /// The callback of long work. It shows the progress, prints messages, and ends the work after an interrupt.
    pub fn watch(&self) -> impl FnMut(Event<'_>) -> ControlFlow<()> + use<> {
        let (interrupt, is_quiet) = (self.interrupt().clone(), self.is_quiet());
        let mut shown: Option<(String, Progress)> = None;
        move |event| {
            match event {
                Event::Progress { what, done, all } => {
                    if done == all {
                        shown = None;
                    } else {
                        let (_, progress) = match &mut shown {
                            Some(same) if same.0 == what => same,
                            other => other.insert((
                                what.to_owned(),
                                Progress::new(what, Some(all), is_quiet),
                            )),
                        };
                        progress.set(done);
                    }
                }
                Event::Warning(text) => match &shown {
                    Some((_, progress)) => progress.note(text),
                    None => super::warn(text),
                },
                Event::Working => {}
            }
            interrupt.flow()
        }
    }
}
