//! Vectors and rotations as arrays of numbers in settings files.

/// The elements of a vector.
pub(crate) mod vector {
    use nalgebra::SVector;
    use serde::de::Error;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub(crate) fn serialize<S: Serializer, const N: usize>(
        vector: &SVector<f64, N>,
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        vector.as_slice().serialize(serializer)
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>, const N: usize>(
        deserializer: D,
    ) -> Result<SVector<f64, N>, D::Error> {
        let elements = Vec::<f64>::deserialize(deserializer)?;
        let array = <[f64; N]>::try_from(elements).map_err(|elements| {
            D::Error::custom(format_args!("{} numbers, expected {N}", elements.len()))
        })?;
        Ok(array.into())
    }
}

/// The unit quaternion \[x, y, z, w\].
pub(crate) mod rotation {
    use nalgebra::{Quaternion, UnitQuaternion, Vector4};
    use serde::de::Error;
    use serde::{Deserializer, Serializer};

    /// Largest deviation of the norm from one, since numbers written by hand have few digits.
    const TOLERANCE: f64 = 1e-3;

    pub(crate) fn serialize<S: Serializer>(
        rotation: &UnitQuaternion<f64>,
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        super::vector::serialize(&rotation.coords, serializer)
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<UnitQuaternion<f64>, D::Error> {
        let coordinates: Vector4<f64> = super::vector::deserialize(deserializer)?;
        let norm = coordinates.norm();
        let quaternion = Quaternion::from(coordinates);
        // Numbers that were written by this code are read back to the last bit.
        if (norm - 1.0).abs() <= 4.0 * f64::EPSILON {
            Ok(UnitQuaternion::new_unchecked(quaternion))
        } else if (norm - 1.0).abs() <= TOLERANCE {
            Ok(UnitQuaternion::new_normalize(quaternion))
        } else {
            Err(D::Error::custom(format_args!(
                "a quaternion [x, y, z, w] of norm {norm}, expected a norm of 1"
            )))
        }
    }
}
