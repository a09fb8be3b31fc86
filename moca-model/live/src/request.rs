//! Requests of a page, as JSON.

use moca_model::Levels;
use moca_simulation::people::{Activity, Facing, Lead, Movement, Reach, Way};
use moca_simulation::workcell::{Faults, Who};
use nalgebra::{Point2, Vector2, Vector3};
use serde::Deserialize;
use vision_models::Tool;

use crate::error::Error;

/// Request of a page, checked.
#[derive(Clone, Debug, PartialEq)]
pub enum Request {
    /// Somebody does this.
    Lead(Who, Lead),
    /// Somebody moves on the spot.
    Move(Who, Movement),
    /// Faults to switch on.
    Faults(Faults),
    /// True if the controller asks for ergonomics.
    Ergonomics(bool),
    /// True if the same robot goes on beside, with the other choice of ergonomics.
    Beside(bool),
    /// True if a second person is there.
    Bystander(bool),
    /// Somebody has seen to the robot.
    Acknowledge,
    /// The robot is to stop.
    Stop,
    /// Everything begins anew.
    Restart(Restart),
    /// A picture was drawn.
    Drawn(u64),
}

/// Settings with which everything begins anew.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Restart {
    /// The person's stature \[m\]; as before if none.
    pub stature: Option<f64>,
    /// True if the person brings the object; as before if none.
    pub hands_over: Option<bool>,
    /// The text of a settings file; settings stay as they are if none.
    pub settings: Option<String>,
    /// The levels of the stack besides those of safety; those of the settings if none.
    pub levels: Option<Levels>,
}

#[derive(Deserialize)]
#[serde(tag = "do", rename_all = "snake_case")]
enum Message {
    Lead(LeadMessage),
    Move(MoveMessage),
    Faults(FaultsMessage),
    Ergonomics(Switch),
    Beside(Switch),
    Bystander(Switch),
    Acknowledge(Nothing),
    Stop(Nothing),
    Restart(Restart),
    Drawn(Drawn),
}

#[derive(Deserialize)]
#[serde(default, deny_unknown_fields)]
struct LeadMessage {
    who: WhoWord,
    way: WayMessage,
    speed: f64,
    facing: FacingMessage,
    activity: ActivityWord,
    tool: ToolWord,
    lean: f64,
    squat: f64,
    reach: ReachWord,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MoveMessage {
    #[serde(default)]
    who: WhoWord,
    movement: String,
}

#[derive(Deserialize)]
#[serde(default, deny_unknown_fields)]
struct FaultsMessage {
    noise: f64,
    lost: f64,
    latency: f64,
    occluded: bool,
    payload: f64,
    push_tool: [f64; 3],
    push_elbow: [f64; 3],
    slip: f64,
    cable: bool,
    measurements: bool,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Switch {
    on: bool,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Drawn {
    picture: u64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Nothing {}

#[derive(Clone, Copy, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
enum WhoWord {
    #[default]
    Worker,
    Bystander,
}

#[derive(Clone, Copy, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
enum WayMessage {
    #[default]
    Stand,
    To([f64; 2]),
    Along([f64; 2]),
}

#[derive(Clone, Copy, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
enum FacingMessage {
    #[default]
    Robot,
    Way,
    Heading(f64),
    Turning(f64),
}

#[derive(Clone, Copy, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
enum ActivityWord {
    #[default]
    Walk,
    Carry,
    Deliver,
    PickUp,
    Hold,
    Use,
    PutDown,
}

#[derive(Clone, Copy, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
enum ToolWord {
    #[default]
    Drill,
    Polisher,
}

#[derive(Clone, Copy, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
enum ReachWord {
    #[default]
    Work,
    Ahead,
    Between,
}

impl Default for LeadMessage {
    fn default() -> Self {
        Self {
            who: WhoWord::default(),
            way: WayMessage::default(),
            speed: Lead::default().speed,
            facing: FacingMessage::default(),
            activity: ActivityWord::default(),
            tool: ToolWord::default(),
            lean: 0.0,
            squat: 0.0,
            reach: ReachWord::default(),
        }
    }
}

impl Default for FaultsMessage {
    fn default() -> Self {
        let none = Faults::default();
        Self {
            noise: none.noise,
            lost: none.lost,
            latency: none.latency,
            occluded: none.occluded,
            payload: none.payload,
            push_tool: none.push_tool.into(),
            push_elbow: none.push_elbow.into(),
            slip: none.slip,
            cable: none.cable,
            measurements: none.measurements,
        }
    }
}

impl From<WhoWord> for Who {
    fn from(word: WhoWord) -> Self {
        match word {
            WhoWord::Worker => Self::Worker,
            WhoWord::Bystander => Self::Bystander,
        }
    }
}

impl LeadMessage {
    fn lead(&self) -> Result<Lead, Error> {
        let tool = match self.tool {
            ToolWord::Drill => Tool::Drill,
            ToolWord::Polisher => Tool::Polisher,
        };
        let lead = Lead {
            way: match self.way {
                WayMessage::Stand => Way::Stand,
                WayMessage::To([x, y]) => Way::To(Point2::new(x, y)),
                WayMessage::Along([x, y]) => Way::Along(Vector2::new(x, y)),
            },
            speed: self.speed,
            facing: match self.facing {
                FacingMessage::Robot => Facing::Robot,
                FacingMessage::Way => Facing::Way,
                FacingMessage::Heading(yaw) => Facing::Heading(yaw),
                FacingMessage::Turning(rate) => Facing::Turning(rate),
            },
            activity: match self.activity {
                ActivityWord::Walk => Activity::Walk,
                ActivityWord::Carry => Activity::CarryObject,
                ActivityWord::Deliver => Activity::DeliverObject,
                ActivityWord::PickUp => Activity::PickUp(tool),
                ActivityWord::Hold => Activity::HoldTool(tool),
                ActivityWord::Use => Activity::Use(tool),
                ActivityWord::PutDown => Activity::PutDown(tool),
            },
            lean: self.lean,
            squat: self.squat,
            reach: match self.reach {
                ReachWord::Work => Reach::Work,
                ReachWord::Ahead => Reach::Ahead,
                ReachWord::Between => Reach::Between,
            },
        };
        lead.validate()?;
        Ok(lead)
    }
}

impl Request {
    /// Reads the text of a message.
    ///
    /// # Errors
    /// Text that is no JSON, asks for something unknown, or has a number out of its range.
    pub fn read(text: &str) -> Result<Self, Error> {
        let message = serde_json::from_str(text)
            .map_err(|error| Error::Request { reason: error.to_string() })?;
        Ok(match message {
            Message::Lead(message) => Self::Lead(message.who.into(), message.lead()?),
            Message::Move(MoveMessage { who, movement }) => {
                let found = Movement::from_name(&movement).ok_or_else(|| Error::Word {
                    what: "movement",
                    got: movement.chars().take(40).collect(),
                    wanted: Movement::ALL.map(Movement::name).join(", "),
                });
                Self::Move(who.into(), found?)
            }
            Message::Faults(message) => {
                let faults = Faults {
                    noise: message.noise,
                    lost: message.lost,
                    latency: message.latency,
                    occluded: message.occluded,
                    payload: message.payload,
                    push_tool: Vector3::from(message.push_tool),
                    push_elbow: Vector3::from(message.push_elbow),
                    slip: message.slip,
                    cable: message.cable,
                    measurements: message.measurements,
                };
                faults.validate()?;
                Self::Faults(faults)
            }
            Message::Ergonomics(Switch { on }) => Self::Ergonomics(on),
            Message::Beside(Switch { on }) => Self::Beside(on),
            Message::Bystander(Switch { on }) => Self::Bystander(on),
            Message::Acknowledge(Nothing {}) => Self::Acknowledge,
            Message::Stop(Nothing {}) => Self::Stop,
            Message::Restart(restart) => Self::Restart(restart),
            Message::Drawn(Drawn { picture }) => Self::Drawn(picture),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn requests_are_read_as_they_are_meant() {
        let text = r#"{"do": "lead", "who": "bystander", "way": {"along": [0, 2]}, "facing": {"heading": 1.5},
            "activity": "use", "tool": "polisher", "reach": "between", "lean": 0.3}"#;
        let lead = Lead {
            way: Way::Along(Vector2::new(0.0, 2.0)),
            facing: Facing::Heading(1.5),
            activity: Activity::Use(Tool::Polisher),
            reach: Reach::Between,
            lean: 0.3,
            ..Lead::default()
        };
        assert_eq!(Request::read(text).unwrap(), Request::Lead(Who::Bystander, lead));
        let stop = Request::read(r#"{"do": "stop"}"#).unwrap();
        assert_eq!(stop, Request::Stop);
        let restart = Restart { levels: Some(Levels::Paper), ..Restart::default() };
        let paper = Request::read(r#"{"do": "restart", "levels": "paper"}"#).unwrap();
        assert_eq!(paper, Request::Restart(restart));
        let faults = Request::read(r#"{"do": "faults", "measurements": true}"#).unwrap();
        assert_eq!(faults, Request::Faults(Faults { measurements: true, ..Faults::default() }));
    }

    #[test]
    fn bad_messages_say_what_is_wrong() {
        for (text, expected) in [
            ("", "this is no request"),
            ("{}", "missing field `do`"),
            ("[1, 2]", "this is no request"),
            (r#"{"do": "fly"}"#, "unknown variant `fly`"),
            (r#"{"do": "stop", "now": true}"#, "unknown field `now`"),
            (r#"{"do": "lead", "height": 2}"#, "unknown field `height`"),
            (r#"{"do": "lead", "speed": 1e400}"#, "number out of range"),
            (r#"{"do": "lead", "speed": -1}"#, "speed = -1: give 0.1 to 1.2 m/s"),
            (r#"{"do": "lead", "way": {"to": [1e9, 0]}}"#, "give a place within 20 m"),
            (r#"{"do": "lead", "way": {"to": [1]}}"#, "invalid length 1"),
            (r#"{"do": "faults", "push_tool": [0, 0, 1e6]}"#, "push_tool = 1000000"),
            (r#"{"do": "faults", "lost": "much"}"#, "invalid type: string"),
            (r#"{"do": "restart", "levels": "none"}"#, "unknown variant `none`"),
            (r#"{"do": "move", "movement": "dance"}"#, "movement \"dance\": give bow"),
        ] {
            let error = Request::read(text).unwrap_err().to_string();
            assert!(error.contains(expected), "{text}: {error}");
        }
    }
}
