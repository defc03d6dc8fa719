//! Prints the JSON Schema of documents as their types have it: `make schema` writes it to
//! `assets/`, a test of the suite compares.

fn main() {
    println!("{}", touchline::document::schema_of_types());
}
