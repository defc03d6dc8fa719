//! What the program ships beside its code, as text and bytes: the crates above read no file of this
//! folder themselves, so that each can be packaged alone.

/// Name and JSON of every built-in field template, in the order in which they are listed.
pub const FIELDS: &[(&str, &str)] = &[
    ("soccer", include_str!("fields/soccer.json")),
    ("futsal", include_str!("fields/futsal.json")),
    (
        "basketball_fiba",
        include_str!("fields/basketball_fiba.json"),
    ),
    ("basketball_nba", include_str!("fields/basketball_nba.json")),
    (
        "basketball_ncaa",
        include_str!("fields/basketball_ncaa.json"),
    ),
    (
        "ice_hockey_iihf",
        include_str!("fields/ice_hockey_iihf.json"),
    ),
    ("ice_hockey_nhl", include_str!("fields/ice_hockey_nhl.json")),
    (
        "american_football_nfl",
        include_str!("fields/american_football_nfl.json"),
    ),
    (
        "american_football_ncaa",
        include_str!("fields/american_football_ncaa.json"),
    ),
    ("tennis", include_str!("fields/tennis.json")),
    ("volleyball", include_str!("fields/volleyball.json")),
    ("handball", include_str!("fields/handball.json")),
    ("badminton", include_str!("fields/badminton.json")),
    ("pickleball", include_str!("fields/pickleball.json")),
    ("padel", include_str!("fields/padel.json")),
    (
        "beach_volleyball",
        include_str!("fields/beach_volleyball.json"),
    ),
    ("field_hockey", include_str!("fields/field_hockey.json")),
    ("rugby_union", include_str!("fields/rugby_union.json")),
    ("squash", include_str!("fields/squash.json")),
];

/// The JSON Schema of documents.
pub const SCHEMA: &str = include_str!("touchline.schema.json");

/// The program's icon, a PNG of 128 × 128 px: made from `desktop/touchline.svg`.
pub const ICON_PNG: &[u8] = include_bytes!("desktop/touchline-128.png");

/// The font of the window's icons: those of Lucide that it uses (`.ci/icons`).
pub const ICONS: &[u8] = include_bytes!("icons/lucide.ttf");

/// The picture of the start page, a JPEG of 800 × 450 px: frame 13 of the demo match, reduced.
pub const START_PICTURE: &[u8] = include_bytes!("start/match.jpg");

/// The Python loader that goes with every dataset.
pub const DATASET_LOADER: &str = include_str!("python/touchline_dataset.py");

/// The page that describes every foreign format, Markdown.
pub const FORMATS: &str = include_str!("formats.md");

/// The user guide: Markdown, a page each, and the pictures that the pages name.
pub mod guide {
    /// `first-project.md`
    pub const FIRST_PROJECT: &str = include_str!("guide/first-project.md");
    /// `window.md`
    pub const WINDOW: &str = include_str!("guide/window.md");
    /// `base.md`
    pub const BASE: &str = include_str!("guide/base.md");
    /// `trust.md`
    pub const TRUST: &str = include_str!("guide/trust.md");
    /// `video.md`
    pub const VIDEO: &str = include_str!("guide/video.md");
    /// `review.md`
    pub const REVIEW: &str = include_str!("guide/review.md");
    /// `quality.md`
    pub const QUALITY: &str = include_str!("guide/quality.md");
    /// `export.md`
    pub const EXPORT: &str = include_str!("guide/export.md");
    /// `several-people.md`
    pub const SEVERAL_PEOPLE: &str = include_str!("guide/several-people.md");
    /// `glossary.md`
    pub const GLOSSARY: &str = include_str!("guide/glossary.md");

    /// The pictures by the names that pages give them (`make pictures` takes them).
    pub const PICTURES: &[(&str, &[u8])] = &[
        (
            "pictures/camera.webp",
            include_bytes!("guide/pictures/camera.webp"),
        ),
        (
            "pictures/export.webp",
            include_bytes!("guide/pictures/export.webp"),
        ),
        (
            "pictures/naming.webp",
            include_bytes!("guide/pictures/naming.webp"),
        ),
        (
            "pictures/quality.webp",
            include_bytes!("guide/pictures/quality.webp"),
        ),
        (
            "pictures/review.webp",
            include_bytes!("guide/pictures/review.webp"),
        ),
        (
            "pictures/solved.webp",
            include_bytes!("guide/pictures/solved.webp"),
        ),
        (
            "pictures/timeline.webp",
            include_bytes!("guide/pictures/timeline.webp"),
        ),
        (
            "pictures/uncertainty.webp",
            include_bytes!("guide/pictures/uncertainty.webp"),
        ),
        (
            "pictures/window.webp",
            include_bytes!("guide/pictures/window.webp"),
        ),
    ];
}
