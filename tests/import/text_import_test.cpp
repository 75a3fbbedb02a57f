// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Files in the form of instruments' manuals, and what must be refused of text.

#include <gtest/gtest.h>

#include "imported.h"

using namespace ada;
using namespace ada::test;

namespace {

/// Three samples, 1.5 V and 2.5 V at first, the time and both voltages growing.
void expect_samples(const Imported &got, double t0, double step, std::size_t n = 3) {
  ASSERT_EQ(got.status, ADA4571_OK) << got.error;
  ASSERT_EQ(got.frames.size(), n) << got.text;
  for (std::size_t i = 0; i < n; ++i) {
    const double k = static_cast<double>(i);
    EXPECT_NEAR(got.frames[i].time_s, t0 + k * step, 1e-9 * step) << got.text;
    EXPECT_DOUBLE_EQ(got.frames[i].vsin_v, 1.5 + 0.25 * k) << got.text;
    EXPECT_DOUBLE_EQ(got.frames[i].vcos_v, 2.5 - 0.25 * k) << got.text;
  }
  ASSERT_TRUE(got.meta.sample_rate_hz) << got.text;
  EXPECT_NEAR(*got.meta.sample_rate_hz, 1.0 / step, 1e-9 / step) << got.text;
}

TEST(TextImport, KeysightNamesInOneLineAndUnitsInTheNext) {
  const char *file = "x-axis,1,2\nsecond,Volt,Volt\n-1.0E-03,+1.50E+00,2.50E+00\n"
                     "-0.5E-03,+1.75E+00,2.25E+00\n+0.0E+00,+2.00E+00,2.00E+00\n";
  expect_samples(import_text(file, pair("#2", "#3")), -1e-3, 0.5e-3);
  const Imported number_or_name = import_text(file, pair("1", "2"));
  EXPECT_EQ(number_or_name.error,
            "file:1: '1' is a column's number and another one's name: give --sin #1 or #2");
}

TEST(TextImport, RigolCountsSamplesAndNamesTheIncrement) {
  expect_samples(import_text("X,CH1,CH2,Start,Increment,\nSequence,Volt,Volt,-1.2e-03,2.0e-06\n"
                             "0,1.5e+00,2.5e+00,,\n1,1.75e+00,2.25e+00,,\n2,2.0,2.0,,\n",
                             pair("CH1", "CH2")),
                 0.0, 2e-6);
}

TEST(TextImport, RigolWithUnitsInTheNames) {
  expect_samples(import_text("Time(s),CH1(V),CH2(V)\r\n0.0,1.5,2.5\r\n1e-6,1.75,2.25\r\n"
                             "2e-6,2.0,2.0\r\n",
                             pair("ch1", "ch2")),
                 0.0, 1e-6);
}

TEST(TextImport, AColumnIsCalledByItsNameWithOrWithoutTheUnit) {
  const char *file =
      "Time(s),CH1 [V],CH1 [mV],CH2_V\n0.0,1.5,0,2.5\n1e-6,1.75,0,2.25\n2e-6,2,0,2\n";
  for (const char *cos : {"CH2", "CH2_V", "ch2 (V)", "CH2 [v]"})
    expect_samples(import_text(file, pair("CH1 [V]", cos)), 0.0, 1e-6);
  for (const char *wrong : {"CH2 [A]", "CH3 [V]", "[V]", "CH1 [V] [V]"})
    EXPECT_NE(import_text(file, pair("CH1 [V]", wrong)).error.find("there is no column"),
              std::string::npos)
        << wrong;
  EXPECT_NE(import_text(file, pair("CH1", "CH2")).error.find("more than one column"),
            std::string::npos);
}

TEST(TextImport, SiglentPreamble) {
  expect_samples(
      import_text("Record Length,Analog:3\nSample Interval,Analog:0.0005\n"
                  "Vertical Units,CH1:V,CH2:V\nVertical Scale,CH1:1.00,CH2:1.00\n"
                  "Vertical Offset,CH1:0,CH2:0\nHorizontal Units,s\nHorizontal Scale,0.001\n"
                  "Model Number,SDS1104X-E\nSerial Number,SDSMMEBD2R1234\nSoftware Version,8.2\n"
                  "Source,CH1,CH2\nSecond,Volt,Volt\n-0.0010,1.5,2.5\n-0.0005,1.75,2.25\n0,2,2\n",
                  pair("CH1", "CH2")),
      -1e-3, 0.5e-3);
}

TEST(TextImport, TektronixPreambleWithEmptyLines) {
  expect_samples(import_text("Model,MSO4054\nFirmware Version,2.68\n\nPoint Format,Y,,\n"
                             "Horizontal Units,S,,\nSample Interval,1e-3,,\nRecord Length,3,,\n"
                             "Probe Attenuation,10,10\n,,\nLabel,,\nTIME,CH1,CH2\n"
                             "0.0,1.5,2.5\n1.0e-3,1.75,2.25\n2.0e-3,2.0,2.0\n",
                             pair("CH1", "CH2")),
                 0.0, 1e-3);
}

TEST(TextImport, PicoScopeUnitsInBracketsAndAGermanComma) {
  expect_samples(import_text("Zeit;Kanal A;Kanal B\n(ms);(V);(mV)\n\n-1,00000000;1,50;2500,0\n"
                             "0,00000000;1,75;2250,0\n1,00000000;2,00;2000,0\n",
                             pair("Kanal A", "Kanal B")),
                 -1e-3, 1e-3);
  const Imported out_of_range =
      import_text("Time,A,B\n(ms),(V),(V)\n\n0,1,2\n1,1,2\n2,1,2\n3,\xE2\x88\x9E,2\n", pair("A", "B"));
  EXPECT_EQ(out_of_range.error, "file:7:3: '\?\?\?' is no number for vsin_v");
}

TEST(TextImport, SaleaeAndNumpySavetxt) {
  expect_samples(import_text("Time [s],VSIN,VCOS\n0,1.5,2.5\n0.01,1.75,2.25\n0.02,2,2\n"), 0.0, 0.01);
  expect_samples(import_text("# t vsin_v vcos_v\n0.0e+00 1.5e+00 2.5e+00\n1e-2 1.75 2.25\n2e-2 2 2\n"),
                 0.0, 0.01);
}

TEST(TextImport, LabViewWithTabsAndDecimalCommas) {
  expect_samples(
      import_text("LabVIEW Measurement\t\nSeparator\tTab\nDecimal_Separator\t,\nX_Columns\tOne\n"
                  "***End_of_Header***\t\n\t\nChannels\t2\t\t\nSamples\t3\t3\t\n"
                  "Y_Unit_Label\tVolts\tVolts\t\nX0\t0,0\t0,0\t\nDelta_X\t0,001\t0,001\t\n"
                  "***End_of_Header***\t\t\t\nX_Value\tSinus\tCosinus\tComment\n"
                  "0,000\t1,50\t2,50\t\n0,001\t1,75\t2,25\t\n0,002\t2,00\t2,00\n"),
      0.0, 1e-3);
}

TEST(TextImport, WithoutTimesTheRateIsAsked) {
  const char *file = "sin;cos\n1.5;2.5\n1.75;2.25\n2;2\n";
  EXPECT_NE(import_text(file).error.find("file:1: no column is known to be the time"),
            std::string::npos)
      << import_text(file).error;
  ImportOptions options;
  options.sample_rate_hz = 400.0;
  expect_samples(import_text(file, options), 0.0, 1 / 400.0);
  // A column of times that is not to be used is no source of a rate either.
  ImportOptions none;
  none.columns[0].column = "";
  const std::string error = import_text("time,sin,cos\n0,1.5,2.5\n0.1,1.75,2.25\n0.2,2,2\n", none).error;
  EXPECT_NE(error.find("give the sample rate by --rate"), error.npos) << error;
}

TEST(TextImport, ScaleOffsetUnitsAndTheOptionalChannels) {
  ImportOptions options;
  options.columns[1].scale = 0.001;
  options.columns[1].offset = 2.5;
  const Imported got = import_text(
      "time_us,sin,cos_mV,vtemp [V],supply,encoder (rad)\n0,-1000,2500,1.6,5,3.1415926535897932\n"
      "100,-750,2250,1.6,5,3.2\n200,-500,2000,1.6,5,3.3\n",
      options);
  expect_samples(got, 0.0, 1e-4);
  EXPECT_TRUE(got.channels.vtemp && got.channels.vdd && got.channels.reference);
  EXPECT_DOUBLE_EQ(got.frames[0].reference_deg, 180.0);
  const Imported unknown = import_text("t,sin,cos,angle\n0,1,2,3\n1,1,2,3\n2,1,2,3\n");
  EXPECT_EQ(unknown.error,
            "file:1: column 4 'angle' does not say whether it is in degrees or radians: give "
            "--reference-unit");
  const Imported wrong = import_text("t,sin (A),cos\n0,1,2\n1,1,2\n2,1,2\n", pair("sin", "cos"));
  EXPECT_EQ(wrong.error, "file:1: column 2 'sin' is in 'A', which is no unit of vsin_v: give "
                         "--scale sin=FACTOR");
}

TEST(TextImport, WhatCanBeTwoThingsIsRefused) {
  EXPECT_NE(import_text("t,CH1,CH2\n0,1,2\n1,1,2\n2,1,2\n").error.find("no column is known to be VSIN"),
            std::string::npos);
  EXPECT_NE(import_text("t,sin a,sin b,cos\n0,1,2,3\n1,1,2,3\n2,1,2,3\n")
                .error.find("column 2 'sin a' and column 3 'sin b' could both be"),
            std::string::npos);
  // Commas between the columns and in the numbers.
  EXPECT_EQ(import_text("t,sin,cos\n0,0,1,5,2,5\n0,1,1,7,2,2\n0,2,2,0,2,0\n").error,
            "file:2:1: the rows have 6 cells and line 1 names 3 columns: a comma cannot be "
            "separator and decimal mark at once");
  EXPECT_EQ(import_text("t,sin,cos\n0,1,2\n1,1,2\n2,1,2\n", pair("sin", "sin")).status,
            ADA4571_ERROR_INVALID_ARGUMENT);
  EXPECT_NE(
      import_text("t,sin,cos\n0,1,2\n1,1,2\n2,1,2\n", pair("sin", "cox"))
          .error.find("there is no column 'cox' for --cos; there are 1 't', 2 'sin', 3 'cos'"),
      std::string::npos);
}

TEST(TextImport, ABadCellIsNamedByLineAndColumn) {
  const std::string head = "t,sin,cos\n0,1,2\n1,1,2\n2,1,2\n";
  EXPECT_EQ(import_text(head + "3,abc,2\n").error, "file:5:3: 'abc' is no number for vsin_v");
  EXPECT_EQ(import_text(head + "3,,2\n").error, "file:5:3: an empty cell is no number for vsin_v");
  EXPECT_EQ(import_text(head + "3,1\n").error, "file:5:4: the row ends before column 3, vcos_v");
  EXPECT_EQ(import_text(head + "3,1,2,9\n").error,
            "file:5:7: the row has 4 cells, the first one has 3");
  EXPECT_EQ(import_text(head + "1.5,1,2\n").error, "file:5:1: the time goes back from 2 s to 1.5 s");
  EXPECT_EQ(import_text(head + "3,1e99,2\n").error, "file:5:3: 1e+99 is out of range for vsin_v");
  EXPECT_EQ(import_text(head + "3,nan,2\n").error, "file:5:3: 'nan' is no number for vsin_v");
  EXPECT_EQ(import_text(head + "\n  \n3,1,2\n\n").frames.size(), 4u);
}

TEST(TextImport, WhatIsNoTableIsRefused) {
  EXPECT_NE(import_text("").error.find("the file is empty"), std::string::npos);
  EXPECT_NE(import_text("hello\nworld\n").error.find("no rows of two or more numbers"),
            std::string::npos);
  EXPECT_NE(import_text(std::string("\xFF\xFE" "t\0,\0", 6)).error.find("UTF-16"), std::string::npos);
  EXPECT_NE(import_text(std::string("a\0b\n", 4)).error.find("file:1:2: this is no text"),
            std::string::npos);
  EXPECT_NE(import_text(std::string(1 << 17, 'a')).error.find("the line is longer"),
            std::string::npos);
}

TEST(TextImport, TheHeadIsOnlyTheHead) {
  std::string file = "t,sin,cos\n";
  for (int i = 0; i < 5000; ++i)
    file += std::to_string(i) + ",1." + std::to_string(i) + ",2\n";
  const Imported got = import_text(file, {}, 512);
  ASSERT_EQ(got.frames.size(), 5000u) << got.error;
  EXPECT_DOUBLE_EQ(got.frames[4321].vsin_v, 1.4321);
  EXPECT_EQ(got.frames[4999].time_s, 4999.0);
  EXPECT_EQ(import_text(file + "5000,x,2\n").error, "file:5002:6: 'x' is no number for vsin_v");
}

TEST(TextImport, OptionsThatCannotBeAreRefused) {
  ImportOptions both;
  both.sample_rate_hz = 10.0;
  both.columns[0].column = "t";
  EXPECT_EQ(import_text("t,sin,cos\n0,1,2\n", both).status, ADA4571_ERROR_INVALID_ARGUMENT);
  ImportOptions zero;
  zero.columns[1].scale = 0.0;
  EXPECT_EQ(import_text("t,sin,cos\n0,1,2\n", zero).status, ADA4571_ERROR_INVALID_ARGUMENT);
  ImportOptions skipped;
  skipped.header_lines = 3;
  EXPECT_EQ(import_text("t,sin,cos\n0,1,2\n1,1,2\nx\n2,1,2\n", skipped).error,
            "file:4:1: after so many header lines no rows of numbers begin");
}

} // namespace
