//! An expression of a field template.
#![no_main]

use libfuzzer_sys::fuzz_target;
use std::collections::BTreeMap;
use touchline::field::Expression;
use touchline_fuzz::{one_line, run_in_bounds};

fuzz_target!(|text: &str| {
    let values = BTreeMap::from([("length_m".to_owned(), 105.0), ("width_m".to_owned(), 68.0)]);
    match run_in_bounds(text.as_bytes(), || Expression::parse(text)) {
        Ok(expression) => {
            assert_eq!(expression.text(), text);
            match expression.evaluate(&values, &[]) {
                Ok(value) => assert!(value.is_finite()),
                Err(error) => one_line(&error, text.as_bytes()),
            }
        }
        Err(error) => one_line(&error, text.as_bytes()),
    }
});
