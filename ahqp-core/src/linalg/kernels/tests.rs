use super::*;
use proptest::prelude::*;

/// A version of `triangularise`.
type Triangularise = fn(&mut RowsMut<'_>, &mut [f64], &mut [f64], f64, f64);

fn rows_of(data: &mut [f64], stride: usize) -> RowsMut<'_> {
    RowsMut { data, stride }
}

/// Returns the product with I − τvvᵀ from the right or from the left, which both kernels must
/// equal.
fn reflected(matrix: &[f64], columns: usize, v: &[f64], tau: f64, left: bool) -> Vec<f64> {
    let rows = matrix.len() / columns;
    let mut out = matrix.to_vec();
    for i in 0..rows {
        for j in 0..columns {
            let change: f64 = if left {
                (0..rows).map(|k| v[k] * matrix[k * columns + j]).sum::<f64>() * v[i]
            } else {
                (0..columns).map(|k| matrix[i * columns + k] * v[k]).sum::<f64>() * v[j]
            };
            out[i * columns + j] -= tau * change;
        }
    }
    out
}

proptest! {
    #[test]
    fn both_versions_are_the_plain_product(
        rows in 1_usize..9, columns in 1_usize..23, start in 0_usize..5, tau in 0.0..2.0_f64,
        entries in prop::collection::vec(-1.0..1.0_f64, 9 * 23),
        v in prop::collection::vec(-1.0..1.0_f64, 23),
    ) {
        let start = start.min(columns - 1);
        let matrix = &entries[..rows * columns];
        let mut wide = vec![0.0; columns];
        wide[start..].copy_from_slice(&v[..columns - start]);
        let close = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(x, y)| (x - y).abs() < 1e-12);

        let expected = reflected(matrix, columns, &wide, tau, false);
        let mut plain = matrix.to_vec();
        with::reflect_rows::<Portable>(&mut rows_of(&mut plain, columns), start, &wide[start..], tau);
        let mut fast = matrix.to_vec();
        reflect_rows(&mut rows_of(&mut fast, columns), start, &wide[start..], tau);
        prop_assert!(close(&plain, &expected) && close(&fast, &expected));

        let expected = reflected(matrix, columns, &v[..rows], tau, true);
        let mut plain = matrix.to_vec();
        with::mix_rows::<Portable>(&mut rows_of(&mut plain, columns), columns, &v[..rows], tau);
        let mut fast = matrix.to_vec();
        mix_rows(&mut rows_of(&mut fast, columns), columns, &v[..rows], tau);
        prop_assert!(close(&plain, &expected) && close(&fast, &expected));

        let x = &wide[..columns];
        let expected: Vec<f64> = matrix
            .chunks(columns)
            .map(|row| row.iter().zip(x).map(|(a, b)| a * b).sum())
            .collect();
        let (mut plain, mut fast) = (vec![0.0; rows], vec![0.0; rows]);
        with::multiply_rows::<Portable>(matrix, columns, x, &mut plain);
        multiply_rows(matrix, columns, x, &mut fast);
        prop_assert!(close(&plain, &expected) && close(&fast, &expected));

        let expected: Vec<f64> = (0..columns)
            .map(|j| 1.0 + (0..rows).map(|i| v[i] * matrix[i * columns + j]).sum::<f64>())
            .collect();
        let (mut plain, mut fast) = (vec![1.0; columns], vec![1.0; columns]);
        with::add_rows::<Portable>(matrix, columns, &v[..rows], &mut plain);
        add_rows(matrix, columns, &v[..rows], &mut fast);
        prop_assert!(close(&plain, &expected) && close(&fast, &expected));

        let expected: Vec<f64> =
            matrix.chunks(columns).map(|row| row.iter().map(|a| a * a).sum()).collect();
        let (mut plain, mut fast) = (vec![0.0; rows], vec![0.0; rows]);
        with::square_rows::<Portable>(matrix, columns, &mut plain);
        square_rows(matrix, columns, &mut fast);
        prop_assert!(close(&plain, &expected) && close(&fast, &expected));
    }

    #[test]
    fn four_reflections_are_one_after_the_other(
        rows in 1_usize..9, columns in 1_usize..23, start in 0_usize..5,
        taus in prop::array::uniform4(0.0..0.2_f64),
        entries in prop::collection::vec(-1.0..1.0_f64, 9 * 23),
        vectors in prop::array::uniform4(prop::collection::vec(-1.0..1.0_f64, 23)),
    ) {
        let start = start.min(columns - 1);
        let matrix = &entries[..rows * columns];
        let v = vectors.each_ref().map(|v| &v[start..columns]);
        let factor = FourReflections::factor(v, &taus);
        let orders = [
            (FourReflections::forward(v, &factor), [0, 1, 2, 3]),
            (FourReflections::backward(v, &factor), [3, 2, 1, 0]),
        ];
        for (four, order) in orders {
            let expected = order.iter().fold(matrix.to_vec(), |matrix, &i| {
                let mut wide = vec![0.0; columns];
                wide[start..].copy_from_slice(v[i]);
                reflected(&matrix, columns, &wide, taus[i], false)
            });
            let mut plain = matrix.to_vec();
            with::reflect_rows_four::<Portable>(&mut rows_of(&mut plain, columns), start, &four);
            let mut fast = matrix.to_vec();
            reflect_rows_four(&mut rows_of(&mut fast, columns), start, &four);
            let size = expected.iter().fold(1.0_f64, |size, entry| size.max(entry.abs()));
            let close = |a: &[f64]| a.iter().zip(&expected).all(|(x, y)| (x - y).abs() < 1e-12 * size);
            prop_assert!(close(&plain) && close(&fast));
        }
    }

    #[test]
    fn a_chain_of_rotations_is_their_product(
        rows in 2_usize..9, columns in 1_usize..23,
        entries in prop::collection::vec(-1.0..1.0_f64, 9 * 23),
        chain in prop::collection::vec((0_usize..8, 0.0..6.3_f64), 1..12),
    ) {
        let matrix = &entries[..rows * columns];
        let rotations: Vec<_> = chain
            .iter()
            .map(|&(first, angle)| Rotation {
                first: first % rows,
                second: (first + 1) % rows,
                cosine: angle.cos(),
                sine: angle.sin(),
            })
            .collect();
        let mut expected = matrix.to_vec();
        for &Rotation { first, second, cosine, sine } in &rotations {
            for j in 0..columns {
                let (p, q) = (expected[first * columns + j], expected[second * columns + j]);
                expected[first * columns + j] = cosine * p + sine * q;
                expected[second * columns + j] = cosine * q - sine * p;
            }
        }
        let mut plain = matrix.to_vec();
        with::rotate_rows::<Portable>(&mut rows_of(&mut plain, columns), &rotations);
        let mut fast = matrix.to_vec();
        rotate_rows(&mut rows_of(&mut fast, columns), &rotations);
        let close = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(x, y)| (x - y).abs() < 1e-12);
        prop_assert!(close(&plain, &expected) && close(&fast, &expected));
    }

    #[test]
    fn triangular_rows_have_the_same_normal_equations(
        rank in 1_usize..9, count in 1_usize..7,
        entries in prop::collection::vec(-1.0..1.0_f64, 16 * 12),
    ) {
        // Rows of a target and `rank` coefficients; the first `rank` rows are lower triangular.
        let mut entries = entries.chunks(12);
        let mut next = |coefficients: usize| {
            let row = entries.next().unwrap();
            let mut row: Vec<f64> = row[..=rank].to_vec();
            row[1 + coefficients..].fill(0.0);
            row
        };
        let pivots: Vec<_> = (0..rank).map(|index| next(index + 1)).collect();
        let dependent: Vec<_> = (0..count).map(|_| next(rank)).collect();
        let stride = (rank + 1).next_multiple_of(4);
        let padded = |rows: &[Vec<f64>]| {
            let mut data = vec![0.0; rows.len() * stride];
            for (to, row) in data.chunks_mut(stride).zip(rows) {
                to[..=rank].copy_from_slice(row);
            }
            data
        };
        let product = |rows: &[Vec<f64>], a: usize, b: usize| -> f64 {
            rows.iter().map(|row| row[a] * row[b]).sum()
        };
        let kernels: [Triangularise; 2] =
            [triangularise, with::triangularise::<Portable>];
        for kernel in kernels {
            let mut stack = vec![0.0; stride];
            stack.extend(padded(&dependent));
            let mut result = padded(&pivots);
            let mut column = vec![0.0; count + 1];
            kernel(&mut rows_of(&mut stack, stride), &mut result, &mut column, 0.0, 0.0);
            let result: Vec<_> = result.chunks(stride).map(|row| row[..=rank].to_vec()).collect();
            for (index, row) in result.iter().enumerate() {
                prop_assert!(row[index + 2..].iter().all(|&entry| entry == 0.0), "{result:?}");
            }
            for a in 1..=rank {
                for b in 0..=rank {
                    let expected = product(&pivots, a, b) + product(&dependent, a, b);
                    prop_assert!((product(&result, a, b) - expected).abs() < 1e-12);
                }
            }
        }
    }

    #[test]
    fn rows_outside_are_found(
        rows in 1_usize..65, length in 0.0..2.0_f64,
        entries in prop::collection::vec(-1.0..1.0_f64, 5 * 64),
    ) {
        let part = |index: usize| &entries[64 * index..64 * index + rows];
        let [value, slope, residual] = [part(0), part(1), part(2)];
        let (lower, room) = (part(3), part(4));
        let upper: Vec<f64> = lower.iter().zip(room).map(|(l, room)| l + room.abs()).collect();
        let end = |i: usize| value[i] - residual[i] + length * (slope[i] + residual[i]);
        let gap = |i: usize| (end(i) - lower[i]).abs().min((end(i) - upper[i]).abs());
        prop_assume!((0..rows).all(|i| gap(i) > 1e-12));
        let expected = (0..rows).fold(0, |bits, i| {
            bits | u64::from(end(i) < lower[i] || end(i) > upper[i]) << i
        });
        let moving = MovingRows { value, slope, residual, lower, upper: &upper };
        let (mut plain, mut fast) = (0, u64::MAX);
        with::rows_outside::<Portable>(moving, length, &mut plain);
        rows_outside(moving, length, &mut fast);
        prop_assert_eq!(plain, expected);
        prop_assert_eq!(fast, expected);
    }
}

/// Two rows pull a variable to opposite sides, with equal forces but for rounding.
#[test]
fn balanced_forces_move_nothing() {
    let kernels: [Triangularise; 2] = [triangularise, with::triangularise::<Portable>];
    for kernel in kernels {
        let target = |least: f64| {
            let mut stack = [0.0, 0.0, 0.0, 0.0, -3.0 * (1.0 + 1e-12), 1.0, 0.0, 0.0];
            let mut pivots = [3.0, 1.0, 0.0, 0.0];
            let mut column = [0.0; 2];
            kernel(&mut rows_of(&mut stack, 4), &mut pivots, &mut column, least, 1e-11);
            pivots[0]
        };
        assert_eq!(target(1e-11), 0.0);
        // Such a force is more than rounding beside smaller targets.
        assert!((1e-13..1e-11).contains(&target(0.0).abs()), "{}", target(0.0));
    }
}
