//! The quadratic of a map, and the cost of following it.

use nalgebra::Vector3;

use super::ErgonomicsMap;
use crate::error::{Error, Result};
use crate::quadratic::{
    ErgonomicsQuadratic, FitInput, FitOptions, FitReport, Regret, ScoredPoint, fit_weighted,
};
use crate::region::Region;

/// Number of boxes that estimate the regret.
const BOXES: usize = 400;
/// Range of the edges of these boxes, in statures: about 0.15 to 0.45 m.
const EDGE: [f64; 2] = [0.085, 0.255];
/// Number of points per axis at which the map is searched within a box.
const SEARCH: u32 = 9;

impl ErgonomicsMap {
    /// Fits the convex quadratic of this map over a region (default: the work zone), and reports on
    /// it.
    ///
    /// # Errors
    /// Those of [`ErgonomicsQuadratic::fit`].
    pub fn fit(&self, options: &FitOptions) -> Result<(ErgonomicsQuadratic, FitReport)> {
        let region = options.region.unwrap_or_else(|| Region::work_zone(self.stature(), self.side));
        let points = self.points_in(&region);
        let weights = options.weights(&points);
        let (quadratic, mut report) = fit_weighted(&FitInput { points, weights }, options)?;
        report.regret = Some(self.regret(&quadratic, &region)?);
        Ok((quadratic, report))
    }

    /// Fits a convex quadratic that is accurate around `centre` \[m\].
    ///
    /// Nodes within three radii have the weight exp(-½ (distance / radius)²), in addition to the
    /// options' weights. Refit when the hand has moved by about one radius.
    ///
    /// # Errors
    /// Those of [`ErgonomicsQuadratic::fit`]. The radius \[m\] must be positive and at most 5 m.
    pub fn fit_around(
        &self,
        centre: &Vector3<f64>,
        radius: f64,
        options: &FitOptions,
    ) -> Result<(ErgonomicsQuadratic, FitReport)> {
        let radius = crate::error::within("radius", radius, [1e-3, 5.0], "m")?;
        let reach = Vector3::repeat(3.0 * radius);
        let points: Vec<ScoredPoint> = self
            .points_in(&Region::new(centre - reach, centre + reach)?)
            .into_iter()
            .filter(|point| options.region.is_none_or(|region| region.contains(&point.position)))
            .collect();
        let mut weights = options.weights(&points);
        for (weight, point) in weights.iter_mut().zip(&points) {
            let distance = (point.position - centre).norm() / radius;
            *weight *= (-0.5 * distance * distance).exp();
        }
        fit_weighted(&FitInput { points, weights }, options)
    }

    fn points_in(&self, region: &Region) -> Vec<ScoredPoint> {
        // Nodes on a face are included in spite of rounding.
        let region = region.grown(1e-9 * self.stature());
        self.nodes()
            .filter(|node| region.contains(&node.position))
            .map(|node| ScoredPoint { position: node.position, score: node.score })
            .collect()
    }

    /// Returns the cost of following `quadratic` within `region`, compared with the map: at its
    /// optimum there, and in random boxes.
    ///
    /// # Errors
    /// [`Error::TooFewSamples`] if the map knows almost nothing of the region.
    pub fn regret(&self, quadratic: &ErgonomicsQuadratic, region: &Region) -> Result<Regret> {
        let at_optimum = self.regret_in(quadratic, region);
        let mut random = SplitMix(0x5eed);
        let mut regrets: Vec<f64> = (0..BOXES)
            .filter_map(|_| self.regret_in(quadratic, &random.box_in(region, self.stature())?))
            .collect();
        let (Some(at_optimum), false) = (at_optimum, regrets.is_empty()) else {
            return Err(Error::TooFewSamples { what: "the regret", got: 0, wanted: 1 });
        };
        regrets.sort_by(f64::total_cmp);
        let boxes = regrets.len();
        let rank = (boxes * 95).div_ceil(100).saturating_sub(1);
        Ok(Regret {
            at_optimum,
            boxes_mean: regrets.iter().sum::<f64>() / boxes as f64,
            boxes_p95: regrets.get(rank).copied().unwrap_or(f64::NAN),
            boxes_max: regrets.last().copied().unwrap_or(f64::NAN),
            boxes,
        })
    }

    /// Returns the map at the quadratic's choice in a box, minus the map's minimum there. `None` if
    /// the choice is outside the map's domain.
    fn regret_in(&self, quadratic: &ErgonomicsQuadratic, region: &Region) -> Option<f64> {
        let chosen = self.sample(&quadratic.minimiser_in(region)).ok()?.score;
        let step = region.size() / f64::from(SEARCH - 1);
        let mut lowest = chosen;
        for index in 0..SEARCH * SEARCH * SEARCH {
            let (i, j, k) = (index / (SEARCH * SEARCH), index / SEARCH % SEARCH, index % SEARCH);
            let at = Vector3::new(f64::from(i), f64::from(j), f64::from(k));
            if let Ok(sample) = self.sample(&(region.min() + step.component_mul(&at))) {
                lowest = lowest.min(sample.score);
            }
        }
        // In a region larger than the mesh of the search, nodes may be lower still.
        if region.size().max() > EDGE[1] * self.stature() {
            lowest = self.points_in(region).iter().map(|p| p.score).fold(lowest, f64::min);
        }
        Some(chosen - lowest)
    }
}

/// Steele, Lea & Flood's generator, so that the boxes are the same on every run.
struct SplitMix(u64);

impl SplitMix {
    /// Returns a number uniform in [0, 1).
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        (z >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Returns a box with random edges at a random place within the region.
    fn box_in(&mut self, region: &Region, stature: f64) -> Option<Region> {
        let (mut min, mut max) = (Vector3::zeros(), Vector3::zeros());
        for axis in 0..3 {
            let edge = stature * (EDGE[0] + (EDGE[1] - EDGE[0]) * self.uniform());
            let room = region.size()[axis];
            let edge = edge.min(room);
            min[axis] = region.min()[axis] + (room - edge) * self.uniform();
            max[axis] = min[axis] + edge;
        }
        Region::new(min, max).ok()
    }
}
