//! Lets macOS link a module without its interpreter; does nothing elsewhere.

fn main() {
    pyo3_build_config::add_extension_module_link_args();
}
