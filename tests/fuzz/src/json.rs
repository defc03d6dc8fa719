//! Mutation of JSON by its values: what stays JSON reaches the reader behind the parser.

use crate::json_values::{hostile_values, replace_value};
use serde_json::Value;
use std::sync::LazyLock;

/// Mutates the first `size` bytes behind `prefix` bytes that stay; the new size. Half of what is
/// JSON is mutated by its values, everything else by its bytes, which is libFuzzer's part.
pub fn mutate(
    data: &mut [u8],
    prefix: usize,
    size: usize,
    max_size: usize,
    seed: u32,
    by_bytes: fn(&mut [u8], usize, usize) -> usize,
) -> usize {
    let mut random = Random(seed.into());
    if size <= prefix || max_size <= prefix || random.below(4) == 0 && prefix > 0 {
        return by_bytes(data, size, max_size);
    }
    let read = serde_json::from_slice(&data[prefix..size]);
    let Some(mut value) = read.ok().filter(|_: &Value| random.below(2) == 0) else {
        return prefix + by_bytes(&mut data[prefix..], size - prefix, max_size - prefix);
    };
    for _ in 0..=random.below(3) {
        replace_one(&mut value, &mut random);
    }
    let text = value.to_string();
    if text.len() > max_size - prefix {
        return by_bytes(data, size, max_size);
    }
    data[prefix..prefix + text.len()].copy_from_slice(text.as_bytes());
    prefix + text.len()
}

/// Puts a hostile value, or one from elsewhere in the tree, in the place of one; or takes it away,
/// or has it twice.
fn replace_one(value: &mut Value, random: &mut Random) {
    static HOSTILE: LazyLock<Vec<Value>> = LazyLock::new(hostile_values);
    let share = random.share();
    let new = match random.below(3) {
        0 => None,
        1 => HOSTILE.get(random.below(HOSTILE.len() as u64) as usize).cloned(),
        _ => Some(one_of(value, random).clone()),
    };
    replace_value(value, share, new.as_ref());
}

/// Any value within a value.
fn one_of<'a>(value: &'a Value, random: &mut Random) -> &'a Value {
    let inner: Vec<&Value> = match value {
        Value::Array(items) => items.iter().collect(),
        Value::Object(map) => map.values().collect(),
        _ => Vec::new(),
    };
    if inner.is_empty() || random.below(4) == 0 {
        return value;
    }
    one_of(inner[random.below(inner.len() as u64) as usize], random)
}

/// Numbers from a seed (splitmix64).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    fn below(&mut self, end: u64) -> u64 {
        self.next() % end
    }

    fn share(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }
}
