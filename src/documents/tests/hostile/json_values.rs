//! JSON values that a reader does not expect, and the places where they are put; `tests/fuzz`
//! mutates with them as well.

use serde_json::Value;

/// What is put in the place of JSON values.
pub fn hostile_values() -> Vec<Value> {
    let long = "x".repeat(10_000);
    let texts = [
        "",
        "../a",
        "/etc/passwd",
        "C:\\a",
        "a\u{0}b",
        "NaN",
        "\u{1b}[2J",
        "=1+1",
        "0001.jpg",
        &long,
    ];
    let numbers = [
        0.0,
        -1.0,
        0.5,
        1e-320,
        1e308,
        -1e308,
        4_294_967_296.0,
        f64::MAX,
        f64::MIN_POSITIVE,
    ];
    let mut values = vec![
        Value::Null,
        Value::Bool(true),
        u64::MAX.into(),
        i64::MIN.into(),
    ];
    values.extend(texts.into_iter().map(Value::from));
    values.extend(numbers.into_iter().map(Value::from));
    values.extend([
        Value::Array(Vec::new()),
        Value::Object(serde_json::Map::new()),
        vec![0.5; 1000].into(),
    ]);
    values
}

/// The pointers (RFC 6901) to every value within a value.
fn pointers(value: &Value, path: &str, found: &mut Vec<String>) {
    found.push(path.to_owned());
    match value {
        Value::Array(items) => {
            for (index, item) in items.iter().enumerate() {
                pointers(item, &format!("{path}/{index}"), found);
            }
        }
        Value::Object(map) => {
            for (key, item) in map {
                pointers(
                    item,
                    &format!("{path}/{}", key.replace('~', "~0").replace('/', "~1")),
                    found,
                );
            }
        }
        _ => {}
    }
}

/// Puts another value in the place of one, or without another takes it away or has it twice.
pub fn replace_value(value: &mut Value, share: f64, new: Option<&Value>) {
    let mut all = Vec::new();
    pointers(value, "", &mut all);
    let chosen = &all[(share * all.len() as f64) as usize];
    if let Some(new) = new {
        *value.pointer_mut(chosen).unwrap() = new.clone();
        return;
    }
    let Some((parent, last)) = chosen.rsplit_once('/') else {
        return;
    };
    match value.pointer_mut(parent).unwrap() {
        Value::Array(items) => {
            let at: usize = last.parse().unwrap();
            if share < 0.5 {
                items.remove(at);
            } else {
                items.push(items[at].clone());
            }
        }
        Value::Object(map) => drop(map.shift_remove(&last.replace("~1", "/").replace("~0", "~"))),
        _ => {}
    }
}
