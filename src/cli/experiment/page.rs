//! `experiments.html`: the same text as `experiments.md` with the plots in it, one file for any browser.

use pulldown_cmark::{Event, Options, Parser, Tag, TagEnd, html::push_html};

const STYLE: &str = "body { font: 15px/1.5 system-ui, sans-serif; max-width: 1100px; margin: 24px auto; padding: 0 16px; color: #1b2430; } \
    table { border-collapse: collapse; font-variant-numeric: tabular-nums; margin: 12px 0; } \
    th, td { border-bottom: 1px solid #dde2e9; padding: 3px 10px; text-align: left; } \
    tr:hover td { background: #eef2f6; } svg { max-width: 100%; height: auto; } pre { background: #eef2f6; padding: 8px 12px; overflow: auto; }";

/// The page of a text in Markdown whose images are among `figures`, by their files' names.
pub(super) fn html(markdown: &str, figures: &[(String, String)]) -> String {
    let mut page = format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>Experiments · ellipsoid_slam</title>\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'\">\n\
         <style>{STYLE}</style>\n</head>\n<body>\n"
    );
    let mut in_figure = false;
    let events = Parser::new_ext(markdown, Options::ENABLE_TABLES).filter_map(|event| {
        let svg = match &event {
            Event::Start(Tag::Image { dest_url, .. }) => {
                figures.iter().find(|(name, _)| **name == **dest_url).map(|(_, svg)| svg)
            }
            _ => None,
        };
        match event {
            Event::Start(Tag::Image { .. }) if svg.is_some() => {
                in_figure = true;
                svg.map(|svg| Event::Html(svg.clone().into()))
            }
            // The text that stands for the figure where it cannot be shown.
            Event::End(TagEnd::Image) if in_figure => {
                in_figure = false;
                None
            }
            _ if in_figure => None,
            event => Some(event),
        }
    });
    push_html(&mut page, events);
    page + "</body>\n</html>\n"
}
