//! The page: one text without anything from elsewhere.

use std::net::SocketAddr;
use std::sync::LazyLock;

use moca_replay::page::{SCENE_SCRIPTS, SCENE_STYLES, filled};

const HTML: &str = include_str!("page/live.html");
const STYLE: &str = include_str!("page/live.css");
/// Scripts in an order in which a file uses only what stands before it.
const SCRIPTS: [&str; 6] = [
    include_str!("page/rows.js"),
    include_str!("page/link.js"),
    include_str!("page/guide.js"),
    include_str!("page/readings.js"),
    include_str!("page/controls.js"),
    include_str!("page/live.js"),
];

/// The text of the page.
pub(crate) fn html() -> &'static str {
    static PAGE: LazyLock<String> = LazyLock::new(|| {
        let style = [&SCENE_STYLES.concat(), STYLE].concat();
        let script = [SCENE_SCRIPTS.concat(), SCRIPTS.concat()].concat();
        filled(HTML, &[("{{style}}", &style), ("{{script}}", &script)])
    });
    &PAGE
}

/// Header fields that let the page run itself and speak to its own server only.
pub(crate) fn fields(address: SocketAddr) -> String {
    let port = address.port();
    format!(
        "Content-Security-Policy: default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; \
         img-src data:; connect-src ws://127.0.0.1:{port} ws://localhost:{port}; base-uri 'none'; \
         form-action 'none'; frame-ancestors 'none'\r\n"
    )
}
