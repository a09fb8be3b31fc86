//! Properties of all recordings: written data are read back, a cut is detected, and no input makes a reader panic.

use percept_recording::Timing;

use super::*;

fn any_confidence() -> impl Strategy<Value = Confidence> {
    (0.0..=1.0_f64).prop_map(|value| Confidence::new(value).unwrap())
}

fn any_body() -> impl Strategy<Value = Option<Body>> {
    let coordinate = || -100.0..=100.0_f64;
    let joint = (coordinate(), coordinate(), coordinate(), any_confidence())
        .prop_map(|(x, y, z, confidence)| Keypoint { position: Point3::new(x, y, z), confidence });
    prop::collection::vec(prop::option::of(joint), 25).prop_map(|joints| {
        let body = Body::new(joints.try_into().unwrap());
        // A body without joints is nobody.
        Some(body).filter(|body| body.iter().next().is_some())
    })
}

fn any_percepts() -> impl Strategy<Value = Vec<Percept>> {
    let action = (prop::sample::select(Action::ALL.to_vec()), any_confidence())
        .prop_map(|(action, confidence)| RecognisedAction { action, confidence });
    let surface = (prop::sample::select(vec![Surface::Smooth, Surface::Drilled]), any_confidence())
        .prop_map(|(surface, confidence)| RecognisedSurface { surface, confidence });
    let percept = (0.001..9.0_f64, any_body(), prop::option::of(action), prop::option::of(surface));
    (-100.0..100.0_f64, prop::collection::vec(percept, 1..8)).prop_map(|(mut time, percepts)| {
        percepts
            .into_iter()
            .map(|(step, body, action, surface)| {
                time += step;
                Percept { time, body, action, surface }
            })
            .collect()
    })
}

fn written(header: &Header, percepts: &[Percept]) -> Vec<u8> {
    let mut writer = Writer::new(Vec::new(), header).unwrap();
    for percept in percepts {
        writer.write(percept).unwrap();
    }
    writer.finish().unwrap()
}

proptest! {
    /// The data that are read are those that were written, up to the rounding of the format. Writing them again gives
    /// the same bytes.
    #[test]
    fn writing_and_reading_is_a_round_trip(
        percepts in any_percepts(), rate in 0.1..1000.0_f64, stature in prop::option::of(0.5..2.5_f64),
    ) {
        let header = Header { rate, stature, ..Header::default() };
        let bytes = written(&header, &percepts);
        let mut reader = Reader::new(bytes.as_slice()).unwrap();
        prop_assert_eq!(*reader.header(), header);
        let back: Vec<Percept> = reader.by_ref().collect::<Result<_, _>>().unwrap();
        prop_assert_eq!(back.len(), percepts.len());
        for (back, percept) in back.iter().zip(&percepts) {
            prop_assert!((back.time - percept.time).abs() <= 0.51e-6);
            prop_assert_eq!(back.action.map(|seen| seen.action), percept.action.map(|seen| seen.action));
            prop_assert_eq!(
                back.surface.map(|seen| seen.surface),
                percept.surface.map(|seen| seen.surface)
            );
            prop_assert_eq!(back.body.is_some(), percept.body.is_some());
            let (Some(back), Some(body)) = (&back.body, &percept.body) else { continue };
            for joint in Body25::ALL {
                prop_assert_eq!(back.get(joint).is_some(), body.get(joint).is_some());
                let (Some(back), Some(joint)) = (back.get(joint), body.get(joint)) else { continue };
                prop_assert!((back.position - joint.position).amax() <= 0.51e-4);
                prop_assert!((back.confidence.value() - joint.confidence.value()).abs() <= 0.51e-3);
            }
        }
        prop_assert_eq!(written(&header, &back), bytes);
    }

    /// The other people in a frame are kept with everybody's ids, except those without a visible joint. A frame without
    /// others or ids does not mention them.
    #[test]
    fn other_people_are_kept(
        mut percepts in any_percepts(),
        others in prop::collection::vec(prop::collection::vec((any_body(), any::<bool>()), 0..4), 8),
        tracked in any::<bool>(),
    ) {
        let known = |body: Body, id: u64| body.with_id(tracked.then(|| PersonId::new(id)));
        for percept in &mut percepts {
            percept.body = percept.body.take().map(|body| known(body, u64::MAX));
        }
        let others = others.into_iter().map(|bodies| {
            let bodies = bodies.into_iter().zip(10..).map(|((body, has_id), id)| {
                let body = body.unwrap_or_default();
                if has_id { known(body, id) } else { body }
            });
            bodies.collect::<Vec<_>>()
        });
        let others: Vec<_> = others.collect();
        let mut writer = Writer::new(Vec::new(), &Header::default()).unwrap();
        for (percept, others) in percepts.iter().zip(&others) {
            writer.write_people(percept, others, &Timing::default()).unwrap();
        }
        let text = String::from_utf8(writer.finish().unwrap()).unwrap();
        prop_assert!(tracked || !text.contains("ids"));
        let recording = whole(&text, IfPartial::Refuse).unwrap();
        for (back, percept) in recording.percepts.iter().zip(&percepts) {
            let id = |percept: &Percept| percept.body.as_ref().and_then(Body::id);
            prop_assert_eq!(id(back), id(percept));
        }
        for ((back, others), line) in recording.others.iter().zip(&others).zip(text.lines().skip(1)) {
            let seen: Vec<_> = others.iter().filter(|body| body.iter().next().is_some()).collect();
            prop_assert_eq!(back.len(), seen.len());
            prop_assert_eq!(line.contains("others"), !seen.is_empty());
            for (back, body) in back.iter().zip(seen) {
                prop_assert_eq!(back.id(), body.id());
                for joint in Body25::ALL {
                    let (back, joint) = (back.get(joint), body.get(joint));
                    prop_assert_eq!(back.is_some(), joint.is_some());
                    let apart = back.zip(joint).map(|(back, joint)| back.position - joint.position);
                    prop_assert!(apart.is_none_or(|apart| apart.amax() <= 0.51e-4));
                }
            }
        }
    }

    /// A file that is cut anywhere is refused, and its complete frames can be taken.
    #[test]
    fn no_cut_passes_for_a_whole_recording(
        percepts in any_percepts(), at in any::<prop::sample::Index>(), complete in any::<bool>(),
    ) {
        let mut writer = Writer::new(Vec::new(), &Header::default()).unwrap();
        for percept in &percepts {
            writer.write(percept).unwrap();
        }
        let finish = if complete { Writer::finish } else { Writer::finish_partial };
        let text = String::from_utf8(finish(writer).unwrap()).unwrap();
        let cut = &text[..at.index(text.len() - 1)];
        let error = whole(cut, IfPartial::Refuse).unwrap_err();
        // Where each line of the whole text ends.
        let ends = text.match_indices('\n').map(|(end, _)| end);
        let there = ends.filter(|end| *end <= cut.len()).count();
        let frames = there.saturating_sub(1);
        if there > 0 {
            let RecordingError::Cut { frames: found, .. } = error else { panic!("{error}") };
            prop_assert_eq!(found, frames as u64);
        }
        match whole(cut, IfPartial::Take) {
            Ok(taken) => {
                prop_assert_eq!(taken.completeness, Completeness::Partial);
                prop_assert_eq!(taken.percepts.len(), frames);
            }
            Err(error) => prop_assert!(frames == 0, "{error}"),
        }
    }

    /// Reading any file ends, with percepts or an error that names a line.
    #[test]
    fn no_input_makes_a_reader_panic(bytes in prop::collection::vec(any::<u8>(), 0..400), cut in 0..600_usize) {
        let mut text = format!("{HEADER}\n{}\n", good("0.0")).into_bytes();
        text.truncate(cut);
        text.extend(bytes);
        if let Ok(reader) = Reader::new(text.as_slice()) {
            for percept in reader {
                if let Err(error) = percept {
                    prop_assert!(error.to_string().contains("line"));
                }
            }
        }
    }
}
