//! What can be wrong with a folder of frames.

use std::{io, path::PathBuf};

/// Why a folder of frames cannot be read or written: where, what was found, and what would be right.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FramesError {
    /// A file that the system does not let us read or write.
    #[error("{path}: {source}", path = path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// A folder that holds frames already.
    #[error("{path} holds frames already: give a folder without a frames.jsonl", path = path.display())]
    Occupied {
        /// The folder.
        path: PathBuf,
    },
    /// A camera file that is none.
    #[error(
        "{path}: {problem}; give the camera as {{\"format\":\"moca-frames\",\"version\":1,\"width\":640,\
         \"height\":480,\"fx\":615.0,\"fy\":615.0,\"cx\":319.5,\"cy\":239.5,\"depth_scale\":0.001,\
         \"position\":[0.3,1.8,2.3],\"quaternion\":[x,y,z,w],\"noise\":{{\"constant\":0.001,\
         \"quadratic\":0.00416}},\"gravity\":null,\"stature\":null}}",
        path = path.display()
    )]
    Camera {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        problem: String,
    },
    /// A line of the index that is no frame.
    #[error(
        "{path}, line {line}: {problem}; a line is such as {{\"frame\":12,\"time\":0.6,\"arrived\":0.64}}, \
         with \"arrived\" null where it is not known, and the last {{\"end\":{{\"frames\":13}}}}",
        path = path.display()
    )]
    Line {
        /// The index.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// What was found.
        problem: String,
    },
    /// A frame that is not after the one before.
    #[error(
        "{path}, line {line}: frame {frame} of {time} s comes after frame {previous} of \
         {previous_time} s: a frame is there once, and frames are in the order of number and time",
        path = path.display()
    )]
    Order {
        /// The index.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// Its number.
        frame: u64,
        /// Its time (s).
        time: f64,
        /// The number of the one before.
        previous: u64,
        /// The time of the one before (s).
        previous_time: f64,
    },
    /// A frame whose image is not there.
    #[error(
        "{path}, line {line}: frame {frame} is listed, but there is neither {depth}.png nor \
         {depth}.npy: write a frame's images before its line",
        path = path.display(), depth = depth.display()
    )]
    Missing {
        /// The index.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// Its number.
        frame: u64,
        /// The image without its extension.
        depth: PathBuf,
    },
    /// An index without frames.
    #[error("{path} has no frame", path = path.display())]
    Empty {
        /// The index.
        path: PathBuf,
    },
    /// What does not fit together.
    #[error(transparent)]
    Vision(#[from] vision_models::Error),
}
