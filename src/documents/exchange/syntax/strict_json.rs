//! JSON whose objects have unique keys. Usual readers keep the last of two equal keys and lose the
//! other one; in files with picture names as keys that loses a frame.

use serde::de::{Deserializer, Error as _, MapAccess, SeqAccess, Visitor};
use serde_json::{Map, Number, Value};
use std::fmt;

use super::values::shorten;

/// Reads a value.
///
/// # Errors
/// It is not JSON, or a key occurs twice.
pub fn from_str(text: &str) -> Result<Value, serde_json::Error> {
    serde_json::from_str::<Strict>(text).map(|strict| strict.0)
}

/// The error in words that help the user to correct it.
pub fn describe_error(error: &serde_json::Error) -> String {
    error
        .to_string()
        .replace(
            "recursion limit exceeded",
            "lists and objects are nested more than 127 deep",
        )
        .replace("EOF while parsing", "it ends within")
        .replace(
            "expected value",
            "a value is expected (JSON has no NaN and no Infinity)",
        )
}

struct Strict(Value);

impl<'de> serde::Deserialize<'de> for Strict {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(Keys).map(Self)
    }
}

/// Builds values and checks their keys.
struct Keys;

impl<'de> Visitor<'de> for Keys {
    type Value = Value;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a JSON value")
    }

    fn visit_unit<E>(self) -> Result<Value, E> {
        Ok(Value::Null)
    }

    fn visit_bool<E>(self, value: bool) -> Result<Value, E> {
        Ok(Value::Bool(value))
    }

    fn visit_i64<E>(self, value: i64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_u64<E>(self, value: u64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_f64<E>(self, value: f64) -> Result<Value, E> {
        // The parser refuses numbers that overflow, so that none is infinite here.
        Ok(Number::from_f64(value).map_or(Value::Null, Value::Number))
    }

    fn visit_str<E>(self, value: &str) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_string<E>(self, value: String) -> Result<Value, E> {
        Ok(Value::String(value))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Value, A::Error> {
        let mut list = Vec::new();
        while let Some(Strict(item)) = items.next_element()? {
            list.push(item);
        }
        Ok(Value::Array(list))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<Value, A::Error> {
        let mut map = Map::new();
        while let Some((key, Strict(value))) = entries.next_entry::<String, Strict>()? {
            if map.contains_key(&key) {
                return Err(A::Error::custom(format_args!(
                    "the key {:?} occurs twice",
                    shorten(&key)
                )));
            }
            map.insert(key, value);
        }
        Ok(Value::Object(map))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_the_same_as_without_looking_at_keys() {
        let text =
            r#"{"a":[1,-2,3.5,1e300,true,null,"x\u00e9"],"b":{"c":{}},"n":18446744073709551615}"#;
        assert_eq!(
            from_str(text).unwrap(),
            serde_json::from_str::<Value>(text).unwrap()
        );
    }

    #[test]
    fn a_key_twice_is_named_with_its_place() {
        let error = from_str("{\"a\": 1,\n \"a\": 2}").unwrap_err().to_string();
        assert_eq!(error, "the key \"a\" occurs twice at line 2 column 8");
        assert!(
            from_str(r#"[{"a": 1}, {"a": 2}]"#).is_ok(),
            "in objects of their own"
        );
        assert!(
            from_str(&"[".repeat(1000)).is_err(),
            "depth has a limit here too"
        );
    }
}
