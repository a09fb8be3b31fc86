use proptest::prelude::*;

use super::{Factorisation, Purpose, RankTolerances};
use crate::linalg::vector::norm;
use crate::solver::activity::Activity;
use crate::solver::data::{Coefficients, ProblemData};
use crate::solver::settings::Settings;
use crate::testing::{Sizes, hierarchies};

/// Returns the largest difference between the rows in the stack and the rows recomputed from the
/// coordinates, relative to the rows.
fn worst_row(factorisation: &mut Factorisation, data: &ProblemData) -> f64 {
    let mut worst = 0.0_f64;
    for (at, id) in factorisation.stacked.clone().iter().copied().enumerate() {
        let mut row = vec![0.0; factorisation.stride];
        for (entry, &variable) in row.iter_mut().zip(&factorisation.free) {
            *entry = match data.row(id).coefficients() {
                Coefficients::Unit(i) => f64::from(u8::from(i == variable)),
                Coefficients::Dense(coefficients) => coefficients[variable],
            };
        }
        factorisation.orthogonal.turn_rows(&mut row);
        let group = factorisation.groups.iter().find(|g| (g.start..g.end).contains(&at)).unwrap();
        let width = group.first_pivot + group.rank.min(at + 1 - group.start);
        let stored = &factorisation.rows[at * factorisation.stride..][..width];
        let (along, behind) = row.split_at(width);
        let off = along.iter().zip(stored).map(|(a, b)| (a - b).abs()).fold(norm(behind), f64::max);
        worst = worst.max(off / data.norm(id));
    }
    worst
}

/// Returns an activity at one of the row's bounds, if it has one.
fn activated(data: &ProblemData, id: usize) -> Activity {
    if data.is_equality(id) {
        Activity::Equal
    } else if data.upper[id].is_finite() {
        Activity::Upper
    } else if data.lower[id].is_finite() {
        Activity::Lower
    } else {
        Activity::Inactive
    }
}

proptest! {
    /// L and Q belong to the rows, whatever rows come and go. The point equals that of a new
    /// factorisation.
    #[test]
    fn an_updated_factorisation_is_one_made_anew(
        hierarchy in hierarchies(Sizes { variables: 1..=14, levels: 1..=4, rows: 0..=7 }),
        starts_active in prop::collection::vec(prop::bool::weighted(0.2), 80),
        rounds in prop::collection::vec(prop::collection::vec(0_usize..80, 1..4), 1..6),
    ) {
        let mut data = ProblemData::new(&hierarchy);
        data.load(&hierarchy).unwrap();
        let tolerances = RankTolerances::new(Settings::default().rank_tolerance);
        let mut state: Vec<_> = (0..data.len())
            .map(|id| match activated(&data, id) {
                Activity::Equal => Activity::Equal,
                _ if !starts_active[id % 80] => Activity::Inactive,
                active => active,
            })
            .collect();
        let mut updated = Factorisation::new(&data, tolerances);
        prop_assume!(updated.factorise(&data, &state));
        for round in rounds {
            let mut changed: Vec<_> = round.into_iter().map(|id| id % data.len()).collect();
            changed.sort_unstable();
            changed.dedup();
            changed.retain(|&id| !matches!(activated(&data, id), Activity::Equal | Activity::Inactive));
            for &id in &changed {
                let active = state[id].is_active();
                state[id] = if active { Activity::Inactive } else { activated(&data, id) };
            }
            if !(updated.update(&data, &state, &changed) && updated.set_point(&data)) {
                prop_assume!(updated.factorise(&data, &state));
            }
            prop_assert!(worst_row(&mut updated, &data) < 1e-9);
            let mut anew = Factorisation::new(&data, tolerances);
            prop_assert!(anew.factorise(&data, &state));
            // Bounds that became active later are rows of the first group.
            let later = |f: &Factorisation| f.groups.iter().skip(1).map(|g| g.rank).collect();
            let ranks: [Vec<_>; 2] = [&updated, &anew].map(later);
            prop_assert_eq!(&ranks[0], &ranks[1]);
            // If held rows contradict each other, the choice among them is free.
            let free_choice =
                |g: &super::Group| g.purpose == Purpose::Held && g.end - g.start > g.rank;
            if !anew.groups.iter().chain(&updated.groups).any(free_choice) {
                let gap: Vec<_> = updated.x.iter().zip(&anew.x).map(|(a, b)| a - b).collect();
                prop_assert!(norm(&gap) < 1e-6 * (1.0 + norm(&anew.x)));
            }
        }
    }
}
