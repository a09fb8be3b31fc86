//! Second derivatives of frames along directions of the joints.

use nalgebra::{Matrix6xX, Vector3, Vector6};

/// J̇ d of a frame while the joints move at q̇ = d, in the axes of its Jacobian, whose columns go from the root to
/// the frame: with joint i before joint j, ∂J_v,ⱼ/∂qᵢ = J_ω,ᵢ × J_v,ⱼ, the same with i and j exchanged, and
/// ∂J_ω,ⱼ/∂qᵢ = J_ω,ᵢ × J_ω,ⱼ.
pub(super) fn second_derivative(jacobian: &Matrix6xX<f64>, direction: &[f64]) -> Vector6<f64> {
    let (mut linear, mut angular) = (Vector3::zeros(), Vector3::zeros());
    // Of the joints before.
    let mut turn = Vector3::zeros();
    for (column, speed) in jacobian.column_iter().zip(direction) {
        let moves: Vector3<f64> = column.fixed_rows::<3>(0) * *speed;
        let turns: Vector3<f64> = column.fixed_rows::<3>(3) * *speed;
        linear += (turn * 2.0 + turns).cross(&moves);
        angular += turn.cross(&turns);
        turn += turns;
    }
    Vector6::new(linear.x, linear.y, linear.z, angular.x, angular.y, angular.z)
}
