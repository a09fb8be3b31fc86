//! Report on a map and its quadratic, as text and as JSON.

use std::collections::BTreeMap;
use std::fmt;

use ergo_map::{JointAngles, Mode, Validation};
use nalgebra::Vector3;
use serde::Serialize;

use super::assessment::Assessment;
use super::side::side_name;
use super::study::MapStudy;
use crate::error::Error;

/// The report on a map. Numbers are plain, lengths in metres, and positions in the person's frame.
///
/// `Display` formats it as text, [`MapReport::json`] as JSON.
#[derive(Debug, Clone, Serialize)]
pub struct MapReport {
    stature_m: f64,
    hand: &'static str,
    map: MapFigures,
    quadratic: Quadratic,
    fit: Fit,
    regret: Option<RegretFigures>,
    optimum: Place,
    best_node: Node,
    acceptable: AcceptableFigures,
    #[serde(skip_serializing_if = "Option::is_none")]
    validation: Option<ValidationFigures>,
}

#[derive(Debug, Clone, Serialize)]
struct MapFigures {
    score: String,
    nodes: usize,
    min_m: [f64; 3],
    max_m: [f64; 3],
    lowest_score: f64,
    median_score: f64,
    highest_score: f64,
}

#[derive(Debug, Clone, Serialize)]
struct Quadratic {
    hessian_per_m2: [[f64; 3]; 3],
    gradient_per_m: [f64; 3],
    constant: f64,
    eigenvalues_per_m2: [f64; 3],
    bound_active: bool,
}

#[derive(Debug, Clone, Serialize)]
struct Fit {
    samples: usize,
    domain_min_m: [f64; 3],
    domain_max_m: [f64; 3],
    r_squared: f64,
    weighted_r_squared: f64,
    rmse: f64,
    max_error: f64,
    spearman: f64,
    optimum_m: [f64; 3],
}

#[derive(Debug, Clone, Serialize)]
struct RegretFigures {
    at_optimum: f64,
    boxes: usize,
    boxes_mean: f64,
    boxes_p95: f64,
    boxes_max: f64,
}

/// A posture with its scores.
#[derive(Debug, Clone, Serialize)]
struct Place {
    position_m: [f64; 3],
    e_s: f64,
    reba: u8,
    reba_action_level: u8,
    sub_scores: BTreeMap<&'static str, u8>,
    rula: u8,
    rula_action_level: u8,
    contributions: BTreeMap<&'static str, f64>,
    angles_deg: BTreeMap<&'static str, f64>,
}

#[derive(Debug, Clone, Serialize)]
struct Node {
    position_m: [f64; 3],
    e_s: f64,
}

#[derive(Debug, Clone, Serialize)]
struct AcceptableFigures {
    e_s_up_to: f64,
    region_share: f64,
    highest_reba: Option<u8>,
}

#[derive(Debug, Clone, Serialize)]
struct ValidationFigures {
    samples: usize,
    outside: usize,
    score_rmse: f64,
    score_bias: f64,
    spearman: f64,
    joint_rmse_deg: BTreeMap<&'static str, f64>,
}

impl MapReport {
    /// Creates the report on a map, with its agreement with recordings if it was compared with any.
    pub fn new(study: &MapStudy, validation: Option<&Validation>) -> Self {
        let (quadratic, fit) = (&study.quadratic, &study.fit);
        Self {
            stature_m: study.map.stature(),
            hand: side_name(study.map.side()),
            map: MapFigures::new(study),
            quadratic: Quadratic {
                hessian_per_m2: quadratic.hessian().transpose().into(),
                gradient_per_m: (*quadratic.gradient()).into(),
                constant: quadratic.constant(),
                eigenvalues_per_m2: fit.eigenvalues.into(),
                bound_active: fit.bound_active,
            },
            fit: Fit {
                samples: fit.samples,
                domain_min_m: (*fit.domain.min()).into(),
                domain_max_m: (*fit.domain.max()).into(),
                r_squared: fit.r_squared,
                weighted_r_squared: fit.weighted_r_squared,
                rmse: fit.rmse,
                max_error: fit.max_error,
                spearman: fit.spearman,
                optimum_m: fit.optimum.into(),
            },
            regret: fit.regret.map(|regret| RegretFigures {
                at_optimum: regret.at_optimum,
                boxes: regret.boxes,
                boxes_mean: regret.boxes_mean,
                boxes_p95: regret.boxes_p95,
                boxes_max: regret.boxes_max,
            }),
            optimum: Place::new(&study.optimum),
            best_node: Node { position_m: study.best.position.into(), e_s: study.best.score },
            acceptable: AcceptableFigures {
                e_s_up_to: study.acceptable.score,
                region_share: study.acceptable.share,
                highest_reba: study.acceptable.highest_reba,
            },
            validation: validation.map(|agreement| ValidationFigures {
                samples: agreement.samples,
                outside: agreement.outside,
                score_rmse: agreement.score_rmse,
                score_bias: agreement.score_bias,
                spearman: agreement.spearman,
                joint_rmse_deg: degrees(&agreement.joint_rmse),
            }),
        }
    }

    /// Returns the report as JSON.
    ///
    /// # Errors
    /// [`Error::Write`] if the report cannot be converted.
    pub fn json(&self) -> Result<String, Error> {
        serde_json::to_string_pretty(self)
            .map_err(|error| Error::Write { what: "report", source: error.into() })
    }
}

impl MapFigures {
    fn new(study: &MapStudy) -> Self {
        let mut scores: Vec<f64> = study.map.nodes().map(|node| node.score).collect();
        scores.sort_by(f64::total_cmp);
        let at = |index: usize| scores.get(index).copied().unwrap_or(f64::NAN);
        let positions = || study.map.nodes().map(|node| node.position);
        let bounds = |of: fn(&Vector3<f64>, &Vector3<f64>) -> Vector3<f64>| {
            positions().reduce(|a, b| of(&a, &b)).unwrap_or_default().into()
        };
        Self {
            score: match study.map.mode() {
                Mode::Graded => "graded".to_owned(),
                Mode::Faithful { half_width } => {
                    format!("faithful, steps of ±{:.2}°", half_width.to_degrees())
                }
            },
            nodes: scores.len(),
            min_m: bounds(Vector3::inf),
            max_m: bounds(Vector3::sup),
            lowest_score: at(0),
            median_score: at(scores.len() / 2),
            highest_score: at(scores.len().saturating_sub(1)),
        }
    }
}

impl Place {
    fn new(assessment: &Assessment) -> Self {
        let Assessment { reba, rula, contributions, .. } = assessment;
        let parts = reba.sub_scores;
        Self {
            position_m: assessment.hand.into(),
            e_s: assessment.map_score,
            reba: reba.reba,
            reba_action_level: reba.action_level.number(),
            sub_scores: BTreeMap::from([
                ("neck", parts.neck),
                ("trunk", parts.trunk),
                ("legs", parts.legs),
                ("upper_arm", parts.upper_arm),
                ("lower_arm", parts.lower_arm),
                ("wrist", parts.wrist),
            ]),
            rula: rula.rula,
            rula_action_level: rula.action_level.number(),
            contributions: BTreeMap::from([
                ("arms", contributions.arms),
                ("trunk", contributions.trunk),
                ("legs", contributions.legs),
                ("neck", contributions.neck),
            ]),
            angles_deg: degrees(&assessment.angles),
        }
    }
}

fn degrees(angles: &JointAngles) -> BTreeMap<&'static str, f64> {
    JointAngles::NAMES.into_iter().zip(angles.to_array().map(f64::to_degrees)).collect()
}

impl fmt::Display for MapReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { map, quadratic, fit, optimum, best_node, acceptable, .. } = self;
        let mut row = |name: &str, value: String| writeln!(f, "{name:<34}{value}");
        row("stature [m], hand", format!("{:.3}, {}", self.stature_m, self.hand))?;
        row("map: nodes, score", format!("{}, {}", map.nodes, map.score))?;
        row("  from, to [m]", format!("{}, {}", point(map.min_m), point(map.max_m)))?;
        row(
            "  e_s lowest, median, highest",
            format!("{:.3}, {:.3}, {:.3}", map.lowest_score, map.median_score, map.highest_score),
        )?;
        let [h, i, j] = quadratic.hessian_per_m2;
        row("quadratic: H [1/m²]", vector(h))?;
        row("", vector(i))?;
        row("", vector(j))?;
        row("  g [1/m]", vector(quadratic.gradient_per_m))?;
        row("  c", format!("{:9.4}", quadratic.constant))?;
        row("  eigenvalues of H [1/m²]", vector(quadratic.eigenvalues_per_m2))?;
        row("  bound on them active", yes(quadratic.bound_active).to_owned())?;
        row("fit: nodes", fit.samples.to_string())?;
        let domain = format!("{}, {}", point(fit.domain_min_m), point(fit.domain_max_m));
        row("  domain from, to [m]", domain)?;
        row("  R², weighted R²", format!("{:.4}, {:.4}", fit.r_squared, fit.weighted_r_squared))?;
        row("  RMSE, largest error", format!("{:.4}, {:.4}", fit.rmse, fit.max_error))?;
        row("  Spearman's rho", format!("{:.4}", fit.spearman))?;
        row("  optimum [m]", point(fit.optimum_m))?;
        match &self.regret {
            Some(regret) => {
                row("  regret at the optimum", format!("{:.4}", regret.at_optimum))?;
                row(
                    "  in boxes: mean, 95 %, highest",
                    format!(
                        "{:.4}, {:.4}, {:.4} ({} boxes)",
                        regret.boxes_mean, regret.boxes_p95, regret.boxes_max, regret.boxes
                    ),
                )?;
            }
            None => row("  regret", "unknown: the optimum is outside the map".to_owned())?,
        }
        row("at the optimum: hand [m]", point(optimum.position_m))?;
        row("  e_s", format!("{:.3}", optimum.e_s))?;
        row("  REBA, action level", format!("{}, {}", optimum.reba, optimum.reba_action_level))?;
        row("  RULA, action level", format!("{}, {}", optimum.rula, optimum.rula_action_level))?;
        for (name, score) in &optimum.sub_scores {
            row(&format!("  sub-score {}", name.replace('_', " ")), score.to_string())?;
        }
        for (name, score) in &optimum.contributions {
            row(&format!("  contribution {name}"), format!("{score:.3}"))?;
        }
        for (name, angle) in &optimum.angles_deg {
            row(&format!("  {} [deg]", name.replace('_', " ")), format!("{:.1}", angle + 0.0))?;
        }
        let best = format!("{}, {:.3}", point(best_node.position_m), best_node.e_s);
        row("best node of the region [m], e_s", best)?;
        let (share, limit) = (100.0 * acceptable.region_share, acceptable.e_s_up_to);
        row(&format!("acceptable: e_s up to {limit}"), format!("{share:.1} % of the region"))?;
        if let Some(reba) = acceptable.highest_reba {
            row("  highest REBA there", reba.to_string())?;
        }
        if let Some(agreement) = &self.validation {
            let counts = format!("{}, {}", agreement.samples, agreement.outside);
            row("recordings: compared, outside", counts)?;
            row(
                "  e_s: RMSE, bias, Spearman's rho",
                format!(
                    "{:.3}, {:.3}, {:.3}",
                    agreement.score_rmse, agreement.score_bias, agreement.spearman
                ),
            )?;
            for (name, error) in &agreement.joint_rmse_deg {
                row(&format!("  RMSE {} [deg]", name.replace('_', " ")), format!("{error:.1}"))?;
            }
        }
        Ok(())
    }
}

fn point([x, y, z]: [f64; 3]) -> String {
    format!("({x:.3}, {y:.3}, {z:.3})")
}

fn vector([x, y, z]: [f64; 3]) -> String {
    format!("{x:9.4} {y:9.4} {z:9.4}")
}

fn yes(is: bool) -> &'static str {
    if is { "yes" } else { "no" }
}
