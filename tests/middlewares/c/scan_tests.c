/**
 * @file
 * The search for stops in received bytes, byte by byte (scan.h).
 */
#include "scan.h"

#include "check.h"
#include "frames.h"

static epg_console_scan_t scan;
static unsigned int lines;
static unsigned int frames;

/** Passes bytes to the search, and counts the stops. */
static void pass(const void *bytes, size_t length)
{
    for (size_t i = 0; i < length; i++) {
        const epg_console_found_t found = epg_console_scan(&scan, ((const uint8_t *)bytes)[i]);
        lines += found == EPG_CONSOLE_FOUND_LINE ? 1U : 0U;
        frames += found == EPG_CONSOLE_FOUND_FRAME ? 1U : 0U;
    }
}

static void begin(const char *text, size_t length)
{
    scan = (epg_console_scan_t){0};
    lines = 0;
    frames = 0;
    pass(text, length);
}

static size_t frame_of(const char *text, unsigned char *frame)
{
    return encode(text, strlen(text), frame);
}

TEST(a_line_whose_first_word_is_disable_is_a_stop)
{
    static const char *const texts[] = {"disable\n",           "disable\r",     "disable\r\n",       "  \tdisable\n",
                                        "disable it now\n",    "disable\t\n",   "enable\ndisable\n", "\n\rdisable\n",
                                        "disabled\ndisable\n", "di\ndisable\n", "disable \x01\x80\n"};
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        begin(texts[i], strlen(texts[i]));
        CHECK_EQUAL(lines, 1);
        CHECK_EQUAL(frames, 0);
    }
}

TEST(a_stop_is_found_at_the_end_of_its_line)
{
    begin("disable", 7);
    CHECK_EQUAL(lines, 0);
    pass(" now", 4);
    CHECK_EQUAL(lines, 0);
    pass("\n", 1);
    CHECK_EQUAL(lines, 1);
    pass("\n\n", 2);
    CHECK_EQUAL(lines, 1);
    pass("disable\ndisable\n", 16);
    CHECK_EQUAL(lines, 3);
}

TEST(other_lines_are_not_stops)
{
    static const char *const texts[] = {"disabled\n",  "xdisable\n",       "disabl\n",    "Disable\n",
                                        "dis able\n",  "en disable\n",     "disable=1\n", "set disable\n",
                                        "d isable\n",  "disabledisable\n", "enable\n",    "\n",
                                        "disabl\ne\n", "disablE now\n",    "ddisable\n"};
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        begin(texts[i], strlen(texts[i]));
        CHECK_EQUAL(lines + frames, 0);
    }
}

TEST(what_another_program_began_is_not_a_part_of_a_line)
{
    begin("dis", 3);
    epg_console_scan_begin_line(&scan);
    pass("disable\n", 8);
    CHECK_EQUAL(lines, 1);
    begin("set x", 5);
    epg_console_scan_begin_line(&scan);
    pass("disable\n", 8);
    CHECK_EQUAL(lines, 1);
}

TEST(a_frame_with_the_command_is_a_stop)
{
    static const char *const stops[] = {"C\1disable", "C\377disable now", "C\1disable and a long rest of the line"};
    static const char *const others[] = {"C\1disabl", "C\1enable", "S\1disable", "K", "C\1 disable", "C\1xisable"};
    unsigned char frame[LONGEST + 16];
    for (size_t i = 0; i < sizeof stops / sizeof stops[0]; i++) {
        const size_t size = frame_of(stops[i], frame);
        begin("", 0);
        pass(frame, size - 1);
        CHECK_EQUAL(frames, 0);
        pass(frame + size - 1, 1);
        /* The search keeps the beginning of a frame only: of a longer one, the console's input finds the stop. */
        CHECK_EQUAL(frames, strlen(stops[i]) == 9 ? 1 : 0);
        CHECK_EQUAL(lines, 0);
    }
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++) {
        begin((const char *)frame, frame_of(others[i], frame));
        CHECK_EQUAL(lines + frames, 0);
    }
}

TEST(a_damaged_frame_with_the_command_is_not_a_stop)
{
    unsigned char frame[LONGEST + 16];
    const size_t size = frame_of("C\1disable", frame);
    for (size_t at = 1; at + 1 < size; at++) {
        for (unsigned int bit = 0; bit < 8; bit++) {
            (void)frame_of("C\1disable", frame);
            frame[at] ^= (unsigned char)(1U << bit);
            begin((const char *)frame, size);
            CHECK_EQUAL(lines + frames, 0);
        }
    }
}

TEST(a_line_behind_noise_is_a_stop_when_its_frame_does_not_prove_whole)
{
    static const char *const noise[] = {"",     "\n",       "x\n",  "C\1\n", "\n\n\n",
                                        "\1\n", "\377\r\n", "ab\r", "K\n",   "disabled\n"};
    for (size_t i = 0; i < sizeof noise / sizeof noise[0]; i++) {
        begin("\0", 1); /* a zero byte opens a frame */
        pass(noise[i], strlen(noise[i]));
        pass("disable\n", 8);
        CHECK_EQUAL(lines, 0);
        const epg_console_scan_t open = scan;
        pass("\0", 1); /* the next frame begins: this one was damaged */
        CHECK_EQUAL(lines, 1);
        scan = open;
        CHECK(epg_console_scan_end_frame(&scan)); /* or nothing more arrives */
        CHECK(!epg_console_scan_end_frame(&scan));
    }
}

TEST(a_stop_line_inside_of_a_whole_frame_is_a_part_of_its_message)
{
    unsigned char frame[LONGEST + 16];
    begin((const char *)frame, frame_of("\ndisable\n", frame));
    CHECK_EQUAL(lines + frames, 0);
    pass("\0x\0", 3); /* a damaged frame after it */
    CHECK_EQUAL(lines + frames, 0);
    begin((const char *)frame, frame_of("K\ndisable\nand much more than the search keeps of a frame", frame));
    CHECK_EQUAL(lines + frames, 0);
    CHECK(!epg_console_scan_end_frame(&scan));
}

TEST(a_frame_that_ends_by_time_leaves_nothing_behind)
{
    begin("\0\nset x\n", 8);
    CHECK(!epg_console_scan_end_frame(&scan));
    pass("disable\n", 8);
    CHECK_EQUAL(lines, 1);
    unsigned char frame[LONGEST + 16];
    pass(frame, frame_of("C\1disable", frame));
    CHECK_EQUAL(frames, 1);
}

TEST(text_works_after_frames)
{
    unsigned char frame[LONGEST + 16];
    begin((const char *)frame, frame_of("K", frame));
    pass("disable\n", 8);
    CHECK_EQUAL(lines, 1);
    pass(frame, frame_of("C\1disable", frame));
    pass("version\ndisable\n", 16);
    CHECK_EQUAL(lines, 2);
    CHECK_EQUAL(frames, 1);
}

RUN()
