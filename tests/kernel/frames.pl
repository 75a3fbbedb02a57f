#!/usr/bin/perl
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
#
# The test device's tables and what has to come of them, computed apart from the project's own
# code. A table is 32-bit codes in the machine's order, four a row: vsin vcos vtemp vdd.
use strict;
use warnings;

binmode STDOUT;
my %verbs = (
    table  => \&table,
    turn   => \&turn,
    codes  => \&codes,
    scan   => \&scan,
    verify => \&verify,
    times  => \&times,
    from   => \&from_csv,
    grid   => \&grid,
);
my $verb = shift @ARGV // '';
die "usage: frames.pl " . join('|', sort keys %verbs) . " ...\n" unless $verbs{$verb};
$verbs{$verb}->(@ARGV);

sub parse_formats {
    my @formats = map {
        /^(le|be):([su])(\d+)\/(\d+)(?:>>(\d+))?$/ or die "bad format $_\n";
        {big => $1 eq 'be', sign => $2 eq 's', bits => $3, storage => $4, shift => $5 // 0};
    } split ' ', shift;
    return @formats == 1 ? (@formats) x 4 : @formats;
}

sub read_table {
    my ($file) = @_;
    open my $in, '<:raw', $file or die "$file: $!\n";
    local $/;
    my @codes = unpack 'l*', <$in>;
    return map { [@codes[4 * $_ .. 4 * $_ + 3]] } 0 .. @codes / 4 - 1;
}

# table FORMAT ROWS [SEED]: every bit of the format is seen; the ends of the range come first.
sub table {
    my ($text, $rows, $seed) = (@_, 1);
    my @formats = parse_formats($text);
    my $state = $seed;
    for my $row (0 .. $rows - 1) {
        my @codes;
        for my $f (@formats) {
            # Codes are ints in the kernel's interface: 32 unsigned bits stop at half.
            my $bits = !$f->{sign} && $f->{bits} == 32 ? 31 : $f->{bits};
            my $span = 2**$bits;
            my $low = $f->{sign} ? -$span / 2 : 0;
            $state = ($state * 1103515245 + 12345) % 2**31;
            my $high = $state >> 15;
            $state = ($state * 1103515245 + 12345) % 2**31;
            my $random = ($high * 65536 + ($state >> 15)) % $span;
            my @ends = (0, $span - 1, 1, $span - 2, $span / 2, $span / 2 - 1);
            push @codes, $low + ($row < @ends ? $ends[$row] : $random);
        }
        print pack 'l4', @codes;
    }
}

# turn ROWS DEGREES_A_ROW: a turning magnet in 12 bits, the row number (mod 4096) as vtemp.
sub turn {
    my ($rows, $step) = @_;
    my $radian = atan2(1, 1) / 45;
    for my $row (0 .. $rows - 1) {
        my $psi = 2 * $row * $step * $radian;
        print pack 'l4', int(2048.5 + 1187 * sin $psi), int(2048.5 + 1187 * cos $psi),
            $row % 4096, 2048;
    }
}

# codes TABLE: as text, a row a line.
sub codes {
    print "@$_\n" for read_table(@_);
}

# scan TABLE FORMAT FIRST_TIME PERIOD [PADDING]: the bytes that the kernel's node has to deliver.
sub scan {
    my ($file, $text, $time, $period, $padding) = (@_, 0);
    my @formats = parse_formats($text);
    $padding = hex $padding if $padding =~ /^0x/;
    for my $row (read_table($file)) {
        my $bytes = '';
        for my $i (0 .. 3) {
            my $f = $formats[$i];
            my $size = $f->{storage} / 8;
            $bytes .= "\0" x (-length($bytes) % $size);
            my $mask = ((2**$f->{bits} - 1) << $f->{shift});
            my $word = (($row->[$i] << $f->{shift}) & $mask) | ($padding & ~$mask);
            my $little = substr pack('Q<', $word), 0, $size;
            $bytes .= $f->{big} ? reverse $little : $little;
        }
        $bytes .= "\0" x (-length($bytes) % 8);
        print $bytes, pack 'q', $time;
        $time += $period;
    }
}

# times NODE_DATA BYTES: nanoseconds since the first frame; the time stamp stands last in a frame.
sub times {
    my ($file, $size) = @_;
    open my $in, '<:raw', $file or die "$file: $!\n";
    local $/ = \$size;
    my $first;
    while (my $frame = <$in>) {
        my $time = unpack 'q', substr $frame, -8;
        $first //= $time;
        print $time - $first, "\n";
    }
}

# verify FILE TABLE SCALE PERIOD_NS: rows "time vsin vcos vtemp vdd" must be the table's codes, to
# the last bit of a double but for the rounding of the product, a period apart.
sub verify {
    my ($file, $table, $scale, $period) = @_;
    my @rows = read_table($table);
    open my $in, '<', $file or die "$file: $!\n";
    my $n = 0;
    while (<$in>) {
        next if /^#/;
        my ($time, @volts) = split;
        die "row $n: more rows than the table\n" if $n >= @rows;
        for my $i (0 .. 3) {
            my $expected = $rows[$n][$i] * $scale / 1000;
            die "row $n channel $i: is $volts[$i], should be $expected\n"
                if abs($volts[$i] - $expected) > 4.5e-16 * abs $expected;
            my $code = sprintf '%.0f', $volts[$i] * 1000 / $scale;
            die "row $n channel $i: is code $code, should be $rows[$n][$i]\n"
                if $code != $rows[$n][$i];
        }
        die "row $n: time $time\n" if abs($time - $n * $period * 1e-9) > 1e-9;
        $n++;
    }
    die "$n rows, should be " . @rows . "\n" if $n != @rows;
}

# from CSV SCALE: a capture in text form as a table; SCALE in millivolts.
sub from_csv {
    my ($file, $scale) = @_;
    open my $in, '<', $file or die "$file: $!\n";
    my %column;
    while (<$in>) {
        next if /^#/;
        chomp;
        my @cells = split /,/;
        if (!%column) {
            @column{@cells} = 0 .. $#cells;
            next;
        }
        print pack 'l4', map {
            my $volts = exists $column{$_} ? $cells[$column{$_}] : 0;
            sprintf '%.0f', $volts * 1000 / $scale
        } qw(vsin_v vcos_v vtemp_v vdd_v);
    }
}

# grid CSV SCALE ROWS: the first rows of a capture, its volts on the grid of a converter; SCALE in
# millivolts a code.
sub grid {
    my ($file, $scale, $rows) = @_;
    open my $in, '<', $file or die "$file: $!\n";
    my @names;
    while (<$in>) {
        if (/^#/) {
            print;
            next;
        }
        chomp;
        my @cells = split /,/;
        if (!@names) {
            @names = @cells;
            print "$_\n";
            next;
        }
        last if $rows-- <= 0;
        for my $i (0 .. $#cells) {
            $cells[$i] = sprintf '%.7f', $scale / 1000 * sprintf '%.0f', $cells[$i] * 1000 / $scale
                if $names[$i] =~ /_v$/;
        }
        print join(',', @cells), "\n";
    }
}
