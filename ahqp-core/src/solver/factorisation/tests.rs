use proptest::prelude::*;

use super::{Factorisation, Purpose};
use crate::linalg::vector::norm;
use crate::solver::active_set::RowState;
use crate::solver::data::{Coefficients, RowTable};
use crate::solver::settings::Settings;
use crate::testing::{Sizes, hierarchies};

/// The largest difference between the rows as they stand in the stack and as the coordinates make
/// them, relative to the rows.
fn worst_row(factorisation: &Factorisation, table: &RowTable) -> f64 {
    let mut worst = 0.0_f64;
    for (at, &id) in factorisation.stacked.iter().enumerate() {
        let mut row = vec![0.0; factorisation.stride];
        for (entry, &variable) in row.iter_mut().zip(&factorisation.free) {
            *entry = match table.row(id).coefficients() {
                Coefficients::Unit(i) => f64::from(u8::from(i == variable)),
                Coefficients::Dense(coefficients) => coefficients[variable],
            };
        }
        factorisation.turn(&mut row);
        let group = factorisation.groups.iter().find(|g| (g.start..g.end).contains(&at)).unwrap();
        let width = group.first_pivot + group.rank.min(at + 1 - group.start);
        let stored = &factorisation.rows[at * factorisation.stride..][..width];
        let (along, behind) = row.split_at(width);
        let off = along.iter().zip(stored).map(|(a, b)| (a - b).abs()).fold(norm(behind), f64::max);
        worst = worst.max(off / table.norm(id));
    }
    worst
}

/// Active at one of its bounds, if it has one.
fn activated(table: &RowTable, id: usize) -> RowState {
    if table.is_equality(id) {
        RowState::Equal
    } else if table.upper[id].is_finite() {
        RowState::Upper
    } else if table.lower[id].is_finite() {
        RowState::Lower
    } else {
        RowState::Inside
    }
}

proptest! {
    /// Whatever rows come and go: L and Q belong to the rows, and the point is the one that a
    /// factorisation from nothing gives.
    #[test]
    fn an_updated_factorisation_is_one_made_anew(
        hierarchy in hierarchies(Sizes { variables: 1..=14, levels: 1..=4, rows: 0..=7 }),
        starts_active in prop::collection::vec(prop::bool::weighted(0.2), 80),
        rounds in prop::collection::vec(prop::collection::vec(0_usize..80, 1..4), 1..6),
    ) {
        let mut table = RowTable::new(&hierarchy);
        table.load(&hierarchy).unwrap();
        let tolerance = Settings::default().rank_tolerance;
        let mut state: Vec<_> = (0..table.len())
            .map(|id| match activated(&table, id) {
                RowState::Equal => RowState::Equal,
                _ if !starts_active[id % 80] => RowState::Inside,
                active => active,
            })
            .collect();
        let mut updated = Factorisation::new(&table);
        prop_assume!(updated.factorise(&table, &state, tolerance));
        for round in rounds {
            let mut changed: Vec<_> = round.into_iter().map(|id| id % table.len()).collect();
            changed.sort_unstable();
            changed.dedup();
            changed.retain(|&id| !matches!(activated(&table, id), RowState::Equal | RowState::Inside));
            for &id in &changed {
                let active = state[id].is_active();
                state[id] = if active { RowState::Inside } else { activated(&table, id) };
            }
            if !updated.update(&table, &state, &changed, tolerance) {
                prop_assume!(updated.factorise(&table, &state, tolerance));
            }
            prop_assert!(worst_row(&updated, &table) < 1e-9);
            let mut anew = Factorisation::new(&table);
            prop_assert!(anew.factorise(&table, &state, tolerance));
            // Bounds that came later are rows of the first group.
            let later = |f: &Factorisation| f.groups.iter().skip(1).map(|g| g.rank).collect();
            let ranks: [Vec<_>; 2] = [&updated, &anew].map(later);
            prop_assert_eq!(&ranks[0], &ranks[1]);
            // Of held rows that contradict each other, any may be the ones that hold.
            let free_choice =
                |g: &super::Group| g.purpose == Purpose::Held && g.end - g.start > g.rank;
            if !anew.groups.iter().chain(&updated.groups).any(free_choice) {
                let gap: Vec<_> = updated.x.iter().zip(&anew.x).map(|(a, b)| a - b).collect();
                prop_assert!(norm(&gap) < 1e-6 * (1.0 + norm(&anew.x)));
            }
        }
    }
}
