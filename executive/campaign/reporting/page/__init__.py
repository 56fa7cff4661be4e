"""One HTML file without network: text that is escaped by construction, tables, charts."""
