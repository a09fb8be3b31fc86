//! Domain of a ROS graph.

use std::env;

use super::error::Ros2Error;

/// Environment variable that holds the domain.
const VARIABLE: &str = "ROS_DOMAIN_ID";
/// Highest domain whose ports exist.
const LAST: u16 = 232;

/// Number of a ROS graph, 0 to 232. Nodes of different domains cannot see each other.
///
/// ```
/// use moca_drivers::ros2::RosDomain;
///
/// assert_eq!(RosDomain::parse("")?, RosDomain::default());
/// assert_eq!(RosDomain::parse("42")?.number(), 42);
/// assert!(RosDomain::parse("233").is_err());
/// # Ok::<(), moca_drivers::ros2::Ros2Error>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RosDomain(u16);

impl RosDomain {
    /// Returns the domain in `ROS_DOMAIN_ID`, or 0 if the variable is not set.
    ///
    /// # Errors
    /// [`Ros2Error::Domain`]
    pub fn of_environment() -> Result<Self, Ros2Error> {
        env::var_os(VARIABLE).map_or(Ok(Self(0)), |value| Self::parse(&value.to_string_lossy()))
    }

    /// Reads the number of a domain. An empty text is 0, as in ROS.
    ///
    /// # Errors
    /// [`Ros2Error::Domain`]
    pub fn parse(value: &str) -> Result<Self, Ros2Error> {
        if value.is_empty() {
            return Ok(Self(0));
        }
        let domain = value.parse().ok().filter(|domain| *domain <= LAST);
        domain.map(Self).ok_or_else(|| Ros2Error::Domain { value: value.to_owned() })
    }

    /// Returns the number.
    pub fn number(self) -> u16 {
        self.0
    }
}
