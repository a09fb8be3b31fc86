//! A map, its quadratic approximation, and its optimum, as shown in report and pictures.

use ergo_map::{
    Conditions, ErgonomicsMap, ErgonomicsQuadratic, FitOptions, FitReport, MapNode, Person, Region,
    ScoredPoint, Worksheet,
};

use super::assessment::Assessment;
use crate::error::Error;

/// Default of the highest `e_s` of a hand position that counts as acceptable. On maps of average
/// proportions, every node of the work zone with at most this score has REBA 1 or 2.
pub const ACCEPTABLE: f64 = 0.5;

/// A map with all data of its report and its pictures.
///
/// ```
/// use ergo_map::{ErgonomicsMap, MapOptions, Person};
/// use ergo_report::maps::{ACCEPTABLE, MapStudy, slices};
///
/// let person = Person::average();
/// let options = MapOptions { spacing: 0.1, ..Default::default() };
/// let map = ErgonomicsMap::build(&person, &options, None)?;
/// let study = MapStudy::new(map, person, ACCEPTABLE)?;
/// assert!(study.optimum.reba.reba <= 2);
/// assert!(slices(&study)?.starts_with("<svg"));
/// # Ok::<(), ergo_report::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct MapStudy {
    /// The map.
    pub map: ErgonomicsMap,
    /// The person of the map.
    pub person: Person,
    /// The convex quadratic over the work zone.
    pub quadratic: ErgonomicsQuadratic,
    /// Quality of the quadratic. It has no regret if the optimum lies outside the map's domain.
    pub fit: FitReport,
    /// The quadratic's optimum. If that lies outside the map's domain, the node with the lowest
    /// value of the quadratic.
    pub optimum: Assessment,
    /// The node of the fit's region with the lowest score.
    pub best: MapNode,
    /// The acceptable hand positions.
    pub acceptable: Acceptable,
}

/// The hand positions with a score up to a threshold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Acceptable {
    /// The threshold of `e_s`.
    pub score: f64,
    /// Share of the nodes in the fit's region that are acceptable, from 0 to 1.
    pub share: f64,
    /// Highest REBA among the acceptable nodes, if there are any.
    pub highest_reba: Option<u8>,
}

impl MapStudy {
    /// Fits the quadratic of a map over the person's work zone.
    ///
    /// # Errors
    /// [`Error::Map`] if the map knows too little of the work zone. [`Error::Value`] if the
    /// threshold is outside ]0, 4.25].
    pub fn new(map: ErgonomicsMap, person: Person, acceptable: f64) -> Result<Self, Error> {
        if !(acceptable > 0.0 && acceptable <= 4.25) {
            let wanted = "a score e_s above 0 and up to 4.25";
            return Err(Error::Value { what: "acceptable", got: acceptable, wanted });
        }
        let (quadratic, fit) = fit(&map)?;
        let inside: Vec<MapNode> =
            map.nodes().filter(|node| fit.domain.contains(&node.position)).collect();
        let none = ergo_map::Error::TooFewSamples { what: "the work zone", got: 0, wanted: 1 };
        let best = inside.iter().min_by(|a, b| a.score.total_cmp(&b.score));
        let best = *best.ok_or(none.clone())?;
        let chosen = if map.contains(&fit.optimum) {
            fit.optimum
        } else {
            let value = |node: &&MapNode| quadratic.value(&node.position);
            let known = inside.iter().filter(|node| map.contains(&node.position));
            known.min_by(|a, b| value(a).total_cmp(&value(b))).ok_or(none)?.position
        };
        let optimum = Assessment::new(&map, &person, &chosen)?;
        let acceptable = Acceptable::new(acceptable, &inside)?;
        Ok(Self { map, person, quadratic, fit, optimum, best, acceptable })
    }
}

/// Returns the map's own fit, or that of its bare nodes if the regret cannot be computed.
fn fit(map: &ErgonomicsMap) -> Result<(ErgonomicsQuadratic, FitReport), ergo_map::Error> {
    let zone = Region::work_zone(map.stature(), map.side());
    let options = FitOptions { region: Some(zone), ..FitOptions::default() };
    map.fit(&options).or_else(|_| {
        let nodes = map.nodes();
        let points: Vec<_> =
            nodes.map(|node| ScoredPoint { position: node.position, score: node.score }).collect();
        ErgonomicsQuadratic::fit(&points, &options)
    })
}

impl Acceptable {
    fn new(score: f64, nodes: &[MapNode]) -> Result<Self, ergo_map::Error> {
        let mut scores = Vec::new();
        for node in nodes.iter().filter(|node| node.score <= score) {
            let sheet = Worksheet::from_posture(&node.angles.posture(), Conditions::default());
            scores.push(sheet.score()?.reba);
        }
        let share = scores.len() as f64 / nodes.len().max(1) as f64;
        Ok(Self { score, share, highest_reba: scores.into_iter().max() })
    }
}
