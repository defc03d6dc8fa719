//! Values of options that are given by one of a few names.

use clap::builder::{PossibleValuesParser, TypedValueParser};
use std::str::FromStr;
use strum::VariantArray;

/// A parser for a value by its name; the help lists the names.
pub fn value_by_name<T>() -> impl TypedValueParser<Value = T>
where
    T: VariantArray + FromStr<Err = strum::ParseError> + Clone + Send + Sync,
    &'static str: From<&'static T>,
{
    let names = T::VARIANTS.iter().map(<&str>::from);
    PossibleValuesParser::new(names).try_map(|name| name.parse::<T>())
}
