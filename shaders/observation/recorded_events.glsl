// The events of a path in the programs: a buffer.
layout(scalar, set = 0, binding = BINDING_RECORDED_PATH) buffer RecordedPath {
    uint recorded_pixel;   // index, row by row
    uint recorded_sample;  // index
    uint event_count;      // of all events, including those that no longer fit
    RecordedEvent events[];
};

// Whether the event with this number is kept, and where.
bool has_room(uint number, out uint index) {
    index = number;
    return number < events.length();
}
