"""The application put together and served: its beginning, its connections and its end."""
