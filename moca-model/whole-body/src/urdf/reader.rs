//! An XML reader that knows the lines of elements.

use quick_xml::Decoder;
use quick_xml::events::{BytesStart, Event};

use crate::error::{Error, urdf::UrdfError};

/// A reader that visits the elements of a text in order.
pub(super) struct Reader<'a> {
    text: &'a str,
    xml: quick_xml::Reader<&'a [u8]>,
    /// Number of bytes whose lines were counted, and the line there.
    counted: usize,
    line: usize,
}

/// The start of an element.
pub(super) struct Element<'a> {
    start: BytesStart<'a>,
    name: String,
    line: usize,
    decoder: Decoder,
}

impl<'a> Reader<'a> {
    pub(super) fn new(text: &'a str) -> Self {
        let mut xml = quick_xml::Reader::from_str(text);
        let config = xml.config_mut();
        config.expand_empty_elements = true;
        config.allow_dangling_amp = true;
        Self { text, xml, counted: 0, line: 1 }
    }

    /// The <robot> element.
    pub(super) fn root(&mut self) -> Result<Element<'a>, Error> {
        let root = loop {
            match self.event()? {
                Event::Start(start) => break self.element(start),
                Event::Text(text) if text.trim_ascii().is_empty() => {}
                Event::Text(text) => {
                    let rest = text.trim_ascii_start().len() as u64;
                    let line = self.line_at(self.xml.buffer_position().saturating_sub(rest));
                    let found = "text before the first element".to_owned();
                    return Err(Error::from(UrdfError::NotAUrdf { line, found }));
                }
                Event::Eof => return Err(self.no_urdf("no element".into())),
                _ => {}
            }
        };
        if root.name() == "robot" {
            Ok(root)
        } else {
            Err(self.no_urdf(format!("a <{}> element", root.name())))
        }
    }

    /// The next element within `parent`; `None` at the end of `parent`.
    pub(super) fn child(&mut self, parent: &Element) -> Result<Option<Element<'a>>, Error> {
        loop {
            match self.event()? {
                Event::Start(start) => return Ok(Some(self.element(start))),
                Event::End(_) => return Ok(None),
                Event::Eof => return Err(self.truncated(parent.name())),
                _ => {}
            }
        }
    }

    /// Skips to the end of `element`.
    pub(super) fn skip(&mut self, element: &Element) -> Result<(), Error> {
        // Unlike quick-xml's own method this one also names elements that are not closed.
        let mut depth = 0_usize;
        loop {
            match self.event()? {
                Event::Start(_) => depth += 1,
                Event::End(_) if depth == 0 => return Ok(()),
                Event::End(_) => depth -= 1,
                Event::Eof => return Err(self.truncated(element.name())),
                _ => {}
            }
        }
    }

    /// Returns an error if something follows the robot.
    pub(super) fn end(&mut self) -> Result<(), Error> {
        loop {
            match self.event()? {
                Event::Start(start) => {
                    let name = self.element(start).name;
                    return Err(self.no_urdf(format!("a <{name}> element after the robot")));
                }
                Event::Eof => return Ok(()),
                _ => {}
            }
        }
    }

    fn event(&mut self) -> Result<Event<'a>, Error> {
        self.xml.read_event().map_err(|error| {
            let at = self.xml.error_position();
            Error::from(UrdfError::Xml { line: self.line_at(at), reason: error.to_string() })
        })
    }

    fn element(&mut self, start: BytesStart<'a>) -> Element<'a> {
        // The position is that of the element's end, the line that of its start.
        let end = self.xml.buffer_position();
        let line = self.line_at(end.saturating_sub(start.len() as u64 + 1));
        let name = String::from_utf8_lossy(start.name().as_ref()).into_owned();
        Element { start, name, line, decoder: self.xml.decoder() }
    }

    /// The line of a position, which must not be before an earlier one.
    fn line_at(&mut self, position: u64) -> usize {
        let position = usize::try_from(position).unwrap_or(usize::MAX).min(self.text.len());
        let passed = self.text.as_bytes().get(self.counted..position).unwrap_or_default();
        self.line += passed.split(|byte| *byte == b'\n').count() - 1;
        self.counted = self.counted.max(position);
        self.line
    }

    fn truncated(&mut self, element: &str) -> Error {
        let line = self.line_at(self.text.len() as u64);
        Error::from(UrdfError::Truncated { line, element: element.to_owned() })
    }

    fn no_urdf(&mut self, found: String) -> Error {
        let line = self.line_at(self.xml.buffer_position());
        Error::from(UrdfError::NotAUrdf { line, found })
    }
}

impl Element<'_> {
    pub(super) fn name(&self) -> &str {
        &self.name
    }

    pub(super) fn line(&self) -> usize {
        self.line
    }

    /// The attribute's text, if it exists.
    pub(super) fn attribute(&self, name: &str) -> Result<Option<String>, Error> {
        // The check for duplicates takes quadratic time in the number of attributes.
        for attribute in self.start.attributes().with_checks(false) {
            let broken = |reason: String| Error::from(UrdfError::Xml { line: self.line, reason });
            let attribute = attribute.map_err(|error| broken(error.to_string()))?;
            if attribute.key.as_ref() == name.as_bytes() {
                let value = attribute
                    .decode_and_unescape_value(self.decoder)
                    .map_err(|error| broken(error.to_string()))?;
                return Ok(Some(value.into_owned()));
            }
        }
        Ok(None)
    }

    /// The attribute's text, or an error if it is missing.
    pub(super) fn needed(&self, name: &'static str) -> Result<String, Error> {
        self.attribute(name)?.ok_or_else(|| {
            Error::from(UrdfError::Missing {
                line: self.line,
                owner: format!("<{}>", self.name),
                missing: match name {
                    "name" => "attribute `name`",
                    "type" => "attribute `type`",
                    "link" => "attribute `link`",
                    "joint" => "attribute `joint`",
                    _ => "attribute that it needs",
                },
            })
        })
    }

    /// Returns any number, including infinity and NaN.
    pub(super) fn any_number(&self, name: &str) -> Result<Option<f64>, Error> {
        let Some(text) = self.attribute(name)? else {
            return Ok(None);
        };
        let number = text.trim().parse();
        number.map(Some).map_err(|_| self.wrong(name, &text, "a number"))
    }

    /// Returns a finite number of sensible size.
    pub(super) fn number(&self, name: &str) -> Result<Option<f64>, Error> {
        Ok(self.numbers::<1>(name)?.map(|[number]| number))
    }

    pub(super) fn needed_number(&self, name: &str) -> Result<f64, Error> {
        self.number(name)?.ok_or_else(|| self.wrong(name, "", "a finite number"))
    }

    /// Returns three finite numbers of sensible size.
    pub(super) fn vector(&self, name: &str) -> Result<Option<[f64; 3]>, Error> {
        self.numbers(name)
    }

    pub(super) fn numbers<const N: usize>(&self, name: &str) -> Result<Option<[f64; N]>, Error> {
        let Some(text) = self.attribute(name)? else {
            return Ok(None);
        };
        let mut values = [0.0; N];
        let mut words = text.split_whitespace();
        let sensible = |value: &f64| value.abs() <= 1e12;
        for value in &mut values {
            let number = words.next().and_then(|word| word.parse().ok()).filter(sensible);
            *value = number.ok_or_else(|| self.wrong(name, &text, wanted(N)))?;
        }
        if words.next().is_some() {
            return Err(self.wrong(name, &text, wanted(N)));
        }
        Ok(Some(values))
    }

    fn wrong(&self, attribute: &str, got: &str, wanted: &'static str) -> Error {
        Error::from(UrdfError::Attribute {
            line: self.line,
            what: format!("`{attribute}` of <{}>", self.name),
            got: shortened(got),
            wanted,
        })
    }
}

fn wanted(count: usize) -> &'static str {
    match count {
        1 => "a finite number of magnitude 1e12 at most",
        3 => "three finite numbers of magnitude 1e12 at most",
        _ => "four finite numbers of magnitude 1e12 at most",
    }
}

/// The beginning of a text that may be long.
fn shortened(text: &str) -> String {
    let mut short: String = text.chars().take(60).collect();
    if short.len() < text.len() {
        short.push('…');
    }
    short
}
