//! The JSON Schema of documents: `assets/touchline.schema.json`, made from the types (draft
//! 2020-12).
//!
//! It says what a reader must expect; what it says nothing of, such as ids that are unique, is
//! checked when a document is read. After a change of the types: `make schema`.

pub use touchline_assets::SCHEMA;

/// The JSON Schema of documents as their types have it, without the line break at the end.
#[cfg(feature = "schema")]
#[doc(hidden)]
pub fn schema_of_types() -> String {
    let settings = schemars::generate::SchemaSettings::draft2020_12();
    let schema = settings
        .into_generator()
        .into_root_schema_for::<super::read::DocumentJson>();
    format!("{:#}", schema.to_value())
}

#[cfg(test)]
pub(crate) mod tests {
    use super::SCHEMA;
    use serde_json::{Value, json};
    use std::sync::LazyLock;

    /// Larger documents are not checked in tests.
    const MOST_BYTES: usize = 1 << 20;

    static PARSED: LazyLock<Value> = LazyLock::new(|| serde_json::from_str(SCHEMA).unwrap());

    /// Every document that a unit test writes goes through here.
    pub fn assert_valid(text: &str) {
        if text.len() <= MOST_BYTES {
            let faults = faults(&PARSED, &serde_json::from_str(text).unwrap(), "");
            assert!(faults.is_empty(), "{faults:#?}\n{text}");
        }
    }

    /// Where a value does not fit a schema. Of JSON Schema only what ours uses is known; anything
    /// else is a fault of the schema.
    fn faults(schema: &Value, value: &Value, at: &str) -> Vec<String> {
        let Some(rules) = schema.as_object() else {
            return if *schema == Value::Bool(false) {
                vec![format!("{at}: nothing fits")]
            } else {
                Vec::new()
            };
        };
        let mut found = Vec::new();
        let number = value.as_f64();
        for (rule, wanted) in rules {
            let fits = match rule.as_str() {
                "$schema" | "$defs" | "title" | "description" | "default" | "format" => true,
                "$ref" => {
                    let target = wanted
                        .as_str()
                        .and_then(|path| PARSED.pointer(path.strip_prefix('#')?));
                    found.extend(faults(target.unwrap_or(&Value::Bool(false)), value, at));
                    true
                }
                "type" => wanted.as_array().map_or(is_a(wanted, value), |kinds| {
                    kinds.iter().any(|kind| is_a(kind, value))
                }),
                "const" => value == wanted,
                "enum" => wanted
                    .as_array()
                    .is_some_and(|values| values.contains(value)),
                "minimum" => number.is_none_or(|number| number >= wanted.as_f64().unwrap()),
                "maximum" => number.is_none_or(|number| number <= wanted.as_f64().unwrap()),
                "exclusiveMinimum" => number.is_none_or(|number| number > wanted.as_f64().unwrap()),
                "minItems" => value
                    .as_array()
                    .is_none_or(|items| items.len() as u64 >= wanted.as_u64().unwrap()),
                "maxItems" => value
                    .as_array()
                    .is_none_or(|items| items.len() as u64 <= wanted.as_u64().unwrap()),
                "required" => {
                    let keys = wanted
                        .as_array()
                        .unwrap()
                        .iter()
                        .map(|key| key.as_str().unwrap());
                    let missing = keys.filter(|key| value.is_object() && value.get(key).is_none());
                    found.extend(missing.map(|key| format!("{at}/{key} is missing")));
                    true
                }
                "items" => {
                    for (index, item) in value.as_array().into_iter().flatten().enumerate() {
                        found.extend(faults(wanted, item, &format!("{at}/{index}")));
                    }
                    true
                }
                "properties" => {
                    for (key, of) in wanted.as_object().unwrap() {
                        if let Some(held) = value.get(key) {
                            found.extend(faults(of, held, &format!("{at}/{key}")));
                        }
                    }
                    true
                }
                "additionalProperties" => {
                    let known = rules.get("properties").and_then(Value::as_object);
                    for (key, held) in value.as_object().into_iter().flatten() {
                        if known.is_none_or(|known| !known.contains_key(key)) {
                            found.extend(faults(wanted, held, &format!("{at}/{key}")));
                        }
                    }
                    true
                }
                "anyOf" | "oneOf" => {
                    let count = wanted
                        .as_array()
                        .unwrap()
                        .iter()
                        .filter(|way| faults(way, value, at).is_empty())
                        .count();
                    count == 1 || (rule == "anyOf" && count > 1)
                }
                _ => false,
            };
            if !fits {
                found.push(format!("{at}: {rule} {wanted} does not hold for {value}"));
            }
        }
        found
    }

    fn is_a(kind: &Value, value: &Value) -> bool {
        match kind.as_str() {
            Some("object") => value.is_object(),
            Some("array") => value.is_array(),
            Some("string") => value.is_string(),
            Some("number") => value.is_number(),
            Some("integer") => value.as_f64().is_some_and(|number| number.fract() == 0.0),
            Some("boolean") => value.is_boolean(),
            Some("null") => value.is_null(),
            _ => false,
        }
    }

    #[test]
    fn a_document_fits_and_what_is_none_does_not() {
        let good: Value =
            serde_json::from_str(include_str!("../../tests/samples/document-v1.json")).unwrap();
        assert_eq!(faults(&PARSED, &good, ""), Vec::<String>::new());
        for (pointer, bad) in [
            ("/format", json!("coco")),
            ("/version", json!(2)),
            ("/field/template", json!(7)),
            ("/cameras/0/image_size_px", json!([1920])),
            ("/cameras/0/image_size_px", json!([0, 1080])),
            ("/cameras/0/position_m", json!([1.0, 2.0])),
            ("/frames/0/status", json!("done")),
            ("/frames/0/clicks/0/image_px", json!(["1", 2])),
            ("/frames/0/ptz/focal_px", json!(-1.0)),
            ("/frames/0/ptz/focal_px", json!(null)),
        ] {
            let mut document = good.clone();
            *document
                .pointer_mut(pointer)
                .unwrap_or_else(|| panic!("{pointer}")) = bad.clone();
            assert!(
                !faults(&PARSED, &document, "").is_empty(),
                "{pointer} {bad}"
            );
        }
    }
}
