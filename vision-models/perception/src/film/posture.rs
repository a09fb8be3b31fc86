//! The posture of a person along a film.

use ergo_map::Worksheet;
use nalgebra::{Point3, Vector3};
use vision_models::{
    Body, Body25, BodyTracker, CalibratedCamera, MonocularLifter, MonocularSettings, Percept,
    TrackerSettings, TriangulationSettings, Triangulator,
};

use super::view::View;
use crate::error::Error;
use crate::percepts::{Assessor, MeasuredAssessment, PostureSettings};

/// Standard deviation of leg length among people of one stature, as a part of it.
const PROPORTIONS: f64 = 0.04;

/// A person goes no farther from one image to the next (m).
const FAR: f64 = 1.0;

/// Settings by which people on film are placed and scored.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FilmSettings {
    /// Placement of people by one camera.
    pub monocular: MonocularSettings,
    /// Placement of people by several cameras.
    pub triangulation: TriangulationSettings,
    /// Other facts about the person.
    pub posture: PostureSettings,
}

/// The person in one image of a film.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmedPosture {
    /// The number of the image.
    pub number: u64,
    /// The time of the image (s).
    pub time: f64,
    /// The joints in the world, if the person was seen; of one camera with the errors that they have against each other.
    pub body: Option<Body>,
    /// The scores, as long as they are known, and the sheet behind them.
    pub scores: Option<(MeasuredAssessment, Worksheet)>,
}

/// A film: what one camera or several see of people, placed in the world, and the posture of one of them.
///
/// The person is the one with the most joints, and from then on the one nearest to where they were.
#[derive(Debug)]
pub struct Film {
    views: Vec<View>,
    rate: f64,
    placing: Placing,
    assessor: Assessor,
    /// The middle of the person when last seen.
    place: Option<Point3<f64>>,
    tracker: BodyTracker,
}

#[derive(Debug)]
enum Placing {
    Monocular(Box<MonocularLifter>),
    Several(Box<Triangulator>),
}

impl Film {
    /// Takes the views and their cameras in the same order: one whose place above the floor is known, or several.
    ///
    /// # Errors
    /// [`Error::Unfit`] for another number of cameras than views. The same for images of another size than the calibration's,
    /// by more than the hundredth by which codecs pad and crop. [`Error::Vision`] for settings and cameras.
    pub fn new(
        mut views: Vec<View>,
        cameras: Vec<CalibratedCamera>,
        rate: f64,
        settings: &FilmSettings,
    ) -> Result<Self, Error> {
        if views.is_empty() || views.len() != cameras.len() {
            let found = format!("{} films and {} cameras", views.len(), cameras.len());
            return Err(Error::unfit("the views", found, "give a camera for each film"));
        }
        for (view, camera) in views.iter().zip(&cameras) {
            let (calibrated, images) = (camera.intrinsics.size(), view.size());
            let Some(images) = images else { continue };
            let differs =
                |axis: usize| images[axis].abs_diff(calibrated[axis]) * 100 > calibrated[axis];
            if differs(0) || differs(1) {
                let found =
                    format!("calibrated for {calibrated:?} pixels, but the images have {images:?}");
                return Err(Error::at(format!("camera {}", camera.name), found));
            }
        }
        let begin = views.iter().map(View::number).max().unwrap_or_default();
        views.iter_mut().try_for_each(|view| view.skip_to(begin))?;
        let mut cameras = cameras;
        let placing = match (cameras.pop(), cameras.is_empty()) {
            (Some(camera), true) => {
                Placing::Monocular(Box::new(MonocularLifter::new(camera, settings.monocular)?))
            }
            (last, _) => {
                cameras.extend(last);
                Placing::Several(Box::new(Triangulator::new(cameras, settings.triangulation)?))
            }
        };
        let tracker = BodyTracker::new(TrackerSettings::default())?;
        let assessor = Assessor::new(settings.posture);
        Ok(Self { views, rate, placing, assessor, place: None, tracker })
    }

    /// The next image; `None` where the first of the films ends.
    ///
    /// # Errors
    /// What keeps an image from being read, by its name.
    pub fn next_posture(&mut self) -> Result<Option<FilmedPosture>, Error> {
        let number = self.views.first().map_or(0, View::number);
        let mut seen = Vec::with_capacity(self.views.len());
        for view in &mut self.views {
            let Some(people) = view.next_people()? else { return Ok(None) };
            seen.push(people);
        }
        let time = number as f64 / self.rate;
        let bodies: Vec<Body> = match &mut self.placing {
            Placing::Monocular(lifter) => {
                let people = seen.iter().flatten();
                people.filter_map(|person| lifter.lift(person)).map(|placed| placed.body).collect()
            }
            Placing::Several(triangulator) => {
                let images = seen
                    .into_iter()
                    .map(|people| people.into_iter().map(|person| person.image).collect());
                triangulator.people(&images.collect::<Vec<_>>())
            }
        };
        let body = self.choose(bodies);
        let percept = Percept { time, body: body.clone(), action: None, surface: None };
        self.tracker.update(&percept)?;
        let scores = self.assessor.update(time, body.as_ref().unwrap_or(&Body::default()))?;
        let scores = scores.map(|scores| (scores, self.assessor.sheet(&scores)));
        Ok(Some(FilmedPosture { number, time, body, scores }))
    }

    /// The person's stature by the lengths of their limbs, and its standard deviation with that of people's proportions (m).
    pub fn stature(&self) -> Option<[f64; 2]> {
        if let Placing::Monocular(lifter) = &self.placing {
            return lifter.stature();
        }
        let estimate = self.tracker.stature()?;
        let sigma = estimate.standard_error.hypot(PROPORTIONS * estimate.stature);
        Some([estimate.stature, sigma])
    }

    /// The person among everybody.
    fn choose(&mut self, bodies: Vec<Body>) -> Option<Body> {
        let all = bodies.into_iter().filter_map(|body| Some((middle(&body)?, body)));
        let chosen = match self.place {
            Some(before) => all
                .map(|(place, body)| ((place - before).norm(), place, body))
                .filter(|(far, ..)| *far < FAR)
                .min_by(|one, other| one.0.total_cmp(&other.0))
                .map(|(_, place, body)| (place, body)),
            None => all.max_by_key(|(_, body)| body.iter().count()),
        };
        let (place, body) = chosen?;
        self.place = Some(place);
        Some(body)
    }
}

/// The middle of what was seen of a trunk.
fn middle(body: &Body) -> Option<Point3<f64>> {
    use Body25::{LeftHip, LeftShoulder, MidHip, Neck, RightHip, RightShoulder};
    let trunk = [Neck, MidHip, LeftShoulder, RightShoulder, LeftHip, RightHip];
    let seen: Vec<Vector3<f64>> =
        trunk.iter().filter_map(|joint| Some(body.get(*joint)?.position.coords)).collect();
    (!seen.is_empty()).then(|| Point3::from(seen.iter().sum::<Vector3<f64>>() / seen.len() as f64))
}
