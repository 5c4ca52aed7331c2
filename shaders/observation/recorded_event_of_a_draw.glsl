// The events of a path in a browser, where a shader can only write its own pixel: each pixel of a draw renders the same sample, and keeps
// the event whose number is its column.
uniform uint recorded_pixel;   // index, row by row
uniform uint recorded_sample;  // index
uint event_count = 0u;
uint kept_event;
RecordedEvent events[1];

// Whether the event with this number is kept, and where.
bool has_room(uint number, out uint index) {
    index = 0u;
    return number == kept_event;
}
