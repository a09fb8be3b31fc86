//! Prints everything that the crate computes of a robot in given states, as JSON. `tests/golden/cross_check.py`
//! compares it with Pinocchio.
//!
//! `cargo run --release --example dynamics_of_states < request.json`
//!
//! The request is `{"urdf": path, "base": "fixed" | "planar" | "floating", "frames": [name, …], "states": [{"position":
//! {joint: value}, "velocity": …, "acceleration": …, "base_position": […], "base_velocity": […], "base_acceleration":
//! […]}]}`. Moving bases have their entries of q, q̇ and q̈. The answer has matrices by rows, in the order of the
//! `joints` at its beginning.

use std::error::Error;
use std::io::{Read, Write};

use nalgebra::{DMatrix, Matrix3xX, Matrix6xX, Vector3};
use serde_json::{Value, json};
use whole_body::robot::UnusableLimits;
use whole_body::{Axes, Base, Data, Description, FrameId, Model};

fn main() -> Result<(), Box<dyn Error>> {
    let mut text = String::new();
    std::io::stdin().read_to_string(&mut text)?;
    let request: Value = serde_json::from_str(&text)?;
    let base = match request["base"].as_str() {
        Some("floating") => Base::Floating,
        Some("planar") => Base::Planar,
        _ => Base::Fixed,
    };
    let unusable_limits = UnusableLimits::Ignore;
    let description = Description { base, unusable_limits, ..Description::default() };
    let model = Model::from_urdf_file(text_of(&request["urdf"])?, &description)?;
    let frames = list(&request["frames"])
        .iter()
        .map(|name| Ok(model.frame_id(text_of(name)?)?))
        .collect::<Result<Vec<_>, Box<dyn Error>>>()?;
    let mut data = Data::new(&model);
    let states = list(&request["states"])
        .iter()
        .map(|state| answer(&model, &mut data, &frames, state))
        .collect::<Result<Vec<_>, _>>()?;
    let joints: Vec<_> = model.joints().iter().map(|joint| joint.name.as_str()).collect();
    let warnings: Vec<_> = model.warnings().iter().map(ToString::to_string).collect();
    let answer = json!({ "joints": joints, "warnings": warnings, "states": states });
    writeln!(std::io::stdout(), "{answer}")?;
    Ok(())
}

fn answer(
    model: &Model,
    data: &mut Data,
    frames: &[FrameId],
    state: &Value,
) -> Result<Value, Box<dyn Error>> {
    let entries = |of: &str, base: &str, size: usize| {
        let mut entries = numbers(&state[base]);
        let joints = model.joints().iter().skip(match model.base() {
            Base::Fixed => 0,
            Base::Planar => 3,
            Base::Floating => 1,
        });
        entries.extend(joints.filter_map(|joint| state[of][&joint.name].as_f64()));
        if entries.len() == size { Ok(entries) } else { Err(format!("{of}: {entries:?}")) }
    };
    let q = entries("position", "base_position", model.position_count())?;
    let n = model.velocity_count();
    let v = entries("velocity", "base_velocity", n)?;
    let a = entries("acceleration", "base_acceleration", n)?;

    let mut posed = data.pose(model, &q)?;
    let mut gravity = vec![0.0; n];
    posed.gravity_into(&mut gravity)?;
    let mut mass = DMatrix::zeros(n, n);
    posed.mass_matrix_into(&mut mass)?;
    let mut centre = Matrix3xX::zeros(n);
    posed.centre_of_mass_jacobian_into(&mut centre)?;
    let diagonal = nalgebra::UnitVector3::new_normalize(Vector3::new(1.0, 2.0, -1.0));
    let mut of_frames = Vec::new();
    for &frame in frames {
        let pose = posed.placement(frame)?;
        let [mut world, mut local] = [Matrix6xX::zeros(n), Matrix6xX::zeros(n)];
        posed.jacobian_into(frame, Axes::World, &mut world)?;
        posed.jacobian_into(frame, Axes::Local, &mut local)?;
        of_frames.push(json!({
            "position": pose.translation.vector.as_slice(),
            "rotation": pose.rotation.matrix().transpose().as_slice(),
            "jacobian": world.transpose().as_slice(),
            "jacobian_local": local.transpose().as_slice(),
            "effective_mobility": posed.effective_mass(frame, &diagonal).ok().map(f64::recip),
        }));
    }
    let centre_of_mass = posed.centre_of_mass();
    let potential = posed.potential_energy();

    let mut moving = posed.moving(&v)?;
    for (&frame, of_frame) in frames.iter().zip(&mut of_frames) {
        for (key, axes) in [("rate", Axes::World), ("rate_local", Axes::Local)] {
            of_frame[key] = json!(moving.jacobian_rate_times_velocity(frame, axes)?.as_slice());
        }
    }
    let mut torque = vec![0.0; n];
    moving.inverse_dynamics_into(&a, &[], &mut torque)?;
    let mut acceleration = vec![0.0; n];
    // The acceleration of a joint without inertia is null.
    let solved = moving.forward_dynamics_into(&a, &[], &mut acceleration).is_ok();
    Ok(json!({
        "frames": of_frames,
        "gravity": gravity,
        "mass_matrix": mass.transpose().as_slice(),
        "inverse_dynamics": torque,
        "forward_dynamics": solved.then_some(acceleration),
        "centre_of_mass": centre_of_mass.coords.as_slice(),
        "centre_of_mass_jacobian": centre.transpose().as_slice(),
        "potential_energy": potential,
        "kinetic_energy": moving.kinetic_energy(),
        "momentum": moving.momentum().as_slice(),
    }))
}

fn text_of(value: &Value) -> Result<&str, Box<dyn Error>> {
    value.as_str().ok_or_else(|| format!("{value} is no text").into())
}

fn list(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

fn numbers(value: &Value) -> Vec<f64> {
    list(value).iter().filter_map(Value::as_f64).collect()
}
