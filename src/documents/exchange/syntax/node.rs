//! JSON values with their path in the file, for error messages.

use super::strict_json;
use super::values::{shorten, side_px};
use crate::exchange::error::Problem;
use crate::exchange::files::text;
use serde_json::Value;
use std::fmt;
use touchline_core::geometry::ImageSize;

/// A value and its path.
#[derive(Clone, Debug)]
pub(in crate::exchange) struct Node<'a> {
    value: &'a Value,
    path: String,
}

/// The JSON value of a file.
pub(in crate::exchange) fn parse(bytes: &[u8]) -> Result<Value, Problem> {
    strict_json::from_str(text(bytes)?)
        .map_err(|error| Problem::NotJson(strict_json::describe_error(&error)))
}

impl<'a> Node<'a> {
    /// The root value of a file.
    pub fn root(value: &'a Value) -> Self {
        Self {
            value,
            path: String::new(),
        }
    }

    /// The value itself.
    pub const fn value(&self) -> &'a Value {
        self.value
    }

    /// Its path.
    pub fn path(&self) -> &str {
        if self.path.is_empty() {
            "the file"
        } else {
            &self.path
        }
    }

    fn at(&self, value: &'a Value, step: impl fmt::Display, dot: bool) -> Self {
        let dot = if dot && !self.path.is_empty() {
            "."
        } else {
            ""
        };
        Self {
            value,
            path: format!("{}{dot}{step}", self.path),
        }
    }

    fn kind(&self, wanted: &'static str) -> Problem {
        let found = match self.value {
            Value::Null => "null".to_owned(),
            Value::Bool(value) => value.to_string(),
            Value::Number(number) => number.to_string(),
            Value::String(text) => format!("the text {:?}", shorten(text)),
            Value::Array(items) => format!("a list of {}", items.len()),
            Value::Object(_) => "an object".to_owned(),
        };
        Problem::Kind {
            what: self.path().to_owned(),
            wanted,
            found,
        }
    }

    /// A key that may be absent or null.
    pub fn find(&self, key: &str) -> Option<Self> {
        // Programs write `null` for what they do not know, which means the same as no key.
        let value = self.value.get(key).filter(|value| !value.is_null())?;
        Some(self.at(value, key, true))
    }

    /// A required key.
    pub fn key(&self, key: &str) -> Result<Self, Problem> {
        // A list in place of an object is another file, not one with a key too few; the message
        // must say so.
        if !self.value.is_object() {
            return Err(self.kind("an object"));
        }
        let value = self.value.get(key);
        value.map(|value| self.at(value, key, true)).ok_or_else(|| {
            let dot = if self.path.is_empty() { "" } else { "." };
            Problem::Missing(format!("{}{dot}{key}", self.path))
        })
    }

    /// A list.
    fn list(&self) -> Result<&'a [Value], Problem> {
        self.value
            .as_array()
            .map(Vec::as_slice)
            .ok_or_else(|| self.kind("a list"))
    }

    /// The entries of a list, created one by one, because a node is larger than most values.
    pub fn items(&self) -> Result<impl DoubleEndedIterator<Item = Self> + use<'a>, Problem> {
        let (items, list) = (self.list()?, self.clone());
        Ok(items
            .iter()
            .enumerate()
            .map(move |(index, item)| list.at(item, format_args!("[{index}]"), false)))
    }

    /// How many entries a list has.
    pub fn count(&self) -> Result<usize, Problem> {
        self.list().map(<[_]>::len)
    }

    /// The entries of an object, in the file's order.
    pub fn entries(&self) -> Result<impl Iterator<Item = (&'a str, Self)> + use<'a>, Problem> {
        let map = self
            .value
            .as_object()
            .ok_or_else(|| self.kind("an object"))?;
        let object = self.clone();
        Ok(map.iter().map(move |(key, value)| {
            (
                key.as_str(),
                object.at(value, format_args!("[{:?}]", shorten(key)), false),
            )
        }))
    }

    /// A finite number.
    pub fn number(&self) -> Result<f64, Problem> {
        let number = self.value.as_f64().ok_or_else(|| self.kind("a number"))?;
        if number.is_finite() {
            Ok(number)
        } else {
            Err(Problem::NotFinite(self.path().to_owned()))
        }
    }

    /// A number above zero.
    pub fn positive(&self) -> Result<f64, Problem> {
        let value = self.number()?;
        if value > 0.0 {
            return Ok(value);
        }
        Err(Problem::out_of_range(self.path(), value, "above 0"))
    }

    /// A side of a picture.
    pub fn side_px(&self) -> Result<u32, Problem> {
        side_px(self.path(), self.number()?)
    }

    /// The size of a picture, by the keys of its width and height.
    pub fn size_at(&self, width: &str, height: &str) -> Result<ImageSize, Problem> {
        Ok(ImageSize::new(
            self.key(width)?.side_px()?,
            self.key(height)?.side_px()?,
        ))
    }

    /// The same where it may be absent: none where a key is absent or null.
    pub fn find_size(&self, width: &str, height: &str) -> Result<Option<ImageSize>, Problem> {
        match (self.find(width), self.find(height)) {
            (Some(width), Some(height)) => {
                Ok(Some(ImageSize::new(width.side_px()?, height.side_px()?)))
            }
            _ => Ok(None),
        }
    }

    /// The numbers under some keys.
    pub fn numbers_at<const N: usize>(&self, keys: [&str; N]) -> Result<[f64; N], Problem> {
        let mut numbers = [0.0; N];
        for (number, key) in numbers.iter_mut().zip(keys) {
            *number = self.key(key)?.number()?;
        }
        Ok(numbers)
    }

    /// The angles under some keys, degrees.
    ///
    /// # Errors
    /// One of them is missing, or is beyond 3,600°, which is no angle but a damaged number.
    pub fn angles_at<const N: usize>(&self, keys: [&str; N]) -> Result<[f64; N], Problem> {
        const MOST_DEG: f64 = 3600.0;
        let angles = self.numbers_at(keys)?;
        let mut stated = keys.iter().zip(angles);
        match stated.find(|(_, angle_deg)| angle_deg.abs() > MOST_DEG) {
            None => Ok(angles),
            Some((key, value)) => Err(Problem::out_of_range(
                self.key(key)?.path(),
                value,
                "an angle in degrees",
            )),
        }
    }

    /// A list of `N` numbers.
    pub fn numbers<const N: usize>(&self) -> Result<[f64; N], Problem> {
        let found = self.count()?;
        // The count comes first: a list of the wrong length with a text in it is of the wrong
        // length.
        if found == N
            && let Ok(numbers) = <[f64; N]>::try_from(self.all_numbers()?)
        {
            return Ok(numbers);
        }
        Err(Problem::wrong_count(
            format!("{} (numbers)", self.path()),
            N,
            found,
        ))
    }

    /// All numbers of a list.
    pub fn all_numbers(&self) -> Result<Vec<f64>, Problem> {
        self.items()?.map(|item| item.number()).collect()
    }

    /// A text.
    pub fn text(&self) -> Result<&'a str, Problem> {
        self.value.as_str().ok_or_else(|| self.kind("a text"))
    }

    /// The name of an image within the folder; it must not lead out of it.
    pub fn image_name(&self) -> Result<String, Problem> {
        let name = self.text()?;
        safe_path(name)
    }
}

/// A path with `/` between its parts that stays within the folder it starts from.
pub(in crate::exchange) fn safe_path(name: &str) -> Result<String, Problem> {
    // A file written on Windows is read on Linux, where `\` is a letter of a name; and `C:` must
    // lead nowhere on either system.
    let name = name.replace('\\', "/");
    let drive = name.as_bytes().get(1) == Some(&b':');
    let leaves = name.split('/').any(|part| part == "..") || name.starts_with('/') || drive;
    if leaves || name.is_empty() || name.contains('\0') {
        return Err(Problem::LeavesFolder(shorten(&name)));
    }
    Ok(name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn what_is_wrong_is_named_with_its_place() {
        let value = json!({ "cp": { "at": [1.0, null], "name": 7, "size": 0 } });
        let node = Node::root(&value);
        let cp = node.key("cp").unwrap();
        let said = |result: Result<(), Problem>| result.unwrap_err().to_string();
        assert_eq!(
            said(cp.key("at").unwrap().numbers::<2>().map(drop)),
            "cp.at[1]: a number is expected, found null"
        );
        assert_eq!(
            said(cp.key("name").unwrap().text().map(drop)),
            "cp.name: a text is expected, found 7"
        );
        assert_eq!(said(cp.key("pan").map(drop)), "cp.pan is missing");
        assert_eq!(
            said(cp.key("size").unwrap().side_px().map(drop)),
            "cp.size is 0, which must be a whole number from 1 to 65535"
        );
        assert_eq!(
            said(node.key("cp").unwrap().items().map(drop)),
            "cp: a list is expected, found an object"
        );
    }

    #[test]
    fn paths_stay_in_their_folder() {
        assert_eq!(safe_path("a\\b.jpg").unwrap(), "a/b.jpg");
        for bad in ["../a.jpg", "a/../../b.jpg", "/etc/passwd", "C:\\a.jpg", ""] {
            assert!(safe_path(bad).is_err(), "{bad}");
        }
    }
}
