//! The message of a panic in a long function.

use std::any::Any;

/// The message of a panic.
#[must_use]
pub fn panic_message(payload: &(dyn Any + Send)) -> String {
    let text = payload
        .downcast_ref::<&str>()
        .map(|text| (*text).to_owned());
    text.or_else(|| payload.downcast_ref::<String>().cloned())
        .unwrap_or_else(|| "without a message".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::panic::catch_unwind;

    #[test]
    fn a_panic_message_is_found_whether_its_text_is_formatted_or_literal() {
        assert_eq!(panic_message(&"as written"), "as written");
        assert_eq!(panic_message(&String::from("as made")), "as made");
        let payload = catch_unwind(|| std::panic::resume_unwind(Box::new(7))).unwrap_err();
        assert_eq!(panic_message(payload.as_ref()), "without a message");
    }
}
