//! Experiments with recordings in place of simulated people.

use std::ops::ControlFlow;
use std::sync::Arc;

use moca_simulation::experiment::following::{Following, WalkingTrial};
use moca_simulation::experiment::reorientation::Reorientation;
use moca_simulation::experiment::{Conditions, Experiment, Job, Needs, Player, Recorded, Sight};
use moca_simulation::people::{Walker, WalkerSettings};
use moca_simulation::plant::Drive;
use moca_simulation::run::Summary;
use percept_recording::{IfPartial, Reader, Recording, Writer};
use vision_models::{Surface, Tool};

use crate::support::average_map;

/// A person who uses the tool from the seventh second on.
fn walker() -> Walker {
    let settings = WalkerSettings { offer: 0.0, duration: 13.0, ..WalkerSettings::default() };
    Walker::new(settings).unwrap()
}

fn job(recordings: &[Arc<Recorded>]) -> Job {
    Job {
        seed: 1,
        cases: 100,
        duration: 30.0,
        conditions: Conditions { drive: Drive::Kinematic, sight: Sight::Modelled, paper: false },
        recordings: vec!["digest".to_owned(); recordings.len()],
    }
}

/// The walker's recording, as it is read.
fn recordings(needs: Needs) -> Vec<Arc<Recorded>> {
    let mut writer = Writer::new(Vec::new(), &walker().header()).unwrap();
    walker().for_each(|percept| writer.write(&percept).unwrap());
    let text = writer.finish().unwrap();
    let recording = Recording::read(Reader::new(&text[..]).unwrap(), IfPartial::Refuse).unwrap();
    vec![Arc::new(Recorded::new(recording, needs).unwrap())]
}

#[test]
fn recording_gives_person_tool_and_side() {
    let recordings = recordings(Needs::Surfaces);
    let [recording] = &recordings[..] else { panic!("{recordings:?}") };
    assert_eq!((recording.stature, recording.tool), (1.75, Tool::Drill));
    // The side to be drilled faces the camera and not the person.
    assert_eq!(recording.facing_camera, Some(Surface::Drilled));
    let cases = Reorientation::cases(&job(&recordings), &recordings);
    assert_eq!(cases.len(), 1);
    assert_eq!(cases[0].front, Surface::Smooth);
    // The tracked person is where the person was.
    let (mut truth, mut walk) = (recording.walk.truth.iter(), walker());
    while let Some((person, _)) = walk.next_frame() {
        let Some(known) = truth.as_slice().first().filter(|known| known.time == person.time) else {
            continue;
        };
        truth.next();
        if person.time > 3.0 {
            assert!((known.floor - person.floor).norm() < 0.06, "{known:?} {person:?}");
        }
    }
}

#[test]
fn the_same_recording_twice_gives_the_same_bits() {
    let recordings = recordings(Needs::Tools);
    let job = job(&recordings);
    let cases = Following::cases(&job, &recordings);
    assert_eq!(cases.len(), 1);
    let play = || {
        let mut player = Player::new(&|| ControlFlow::Continue(()));
        let trial = Following::play(&cases[0], average_map(), job.conditions, &mut player).unwrap();
        let WalkingTrial::Path(runs) = trial else { panic!("{trial:?}") };
        // Times of the machine do not count.
        runs.map(|run| Summary { tick_us: [0.0; 3], wall: 0.0, ..run })
    };
    let first = play();
    assert!(first.iter().all(|run| run.together > 1.0), "{first:?}");
    let text = |runs| serde_json::to_string(runs).unwrap();
    assert_eq!(text(&first), text(&play()));
}
