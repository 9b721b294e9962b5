# Checks the shape of an export, member by member.
# usage: perl check_export.pl google|hyperfine FILE; prints what is wrong.
use strict;
use warnings;
use JSON::PP;

my ($kind, $path) = @ARGV;
open my $file, '<', $path or die "$path: $!\n";
my $text = do { local $/; <$file> };
my $data = JSON::PP->new->utf8->decode($text);
my $number = qr/^-?\d+(\.\d+)?(e[-+]?\d+)?$/i;

sub is_number { my $value = shift; return scalar(defined $value && $value =~ $number) }
sub keys_of { my ($hash) = @_; return join ' ', sort keys %$hash }
sub expect { my ($fine, $what) = @_; die "$what\n" unless $fine }

sub google {
    for (qw(date host_name executable num_cpus mhz_per_cpu cpu_scaling_enabled caches load_avg
            library_build_type)) {
        expect(exists $data->{context}{$_}, "context lacks $_");
    }
    expect(ref $data->{context}{caches} eq 'ARRAY', 'caches is no array');
    expect($data->{context}{date} eq '2026-01-02T03:04:05Z', 'date');
    expect($data->{context}{host_name} eq 'host' && $data->{context}{num_cpus} == 2, 'host');
    my (%runs, %aggregates);
    for my $b (@{ $data->{benchmarks} }) {
        my $name = $b->{name};
        expect(scalar($name =~ m{^\w+(/\w+:[\w.+%-]+)+$}), "name $name");
        for (qw(real_time cpu_time iterations repetitions threads family_index
                per_family_instance_index)) {
            expect(is_number($b->{$_}), "$name: $_");
        }
        expect($b->{time_unit} eq 'ns' && $b->{repetitions} == 3, "$name: unit, repetitions");
        if ($b->{run_type} eq 'iteration') {
            expect($name eq $b->{run_name}, "$name: run_name");
            push @{ $runs{$name} }, $b;
            expect($b->{repetition_index} == $#{ $runs{$name} }, "$name: repetition_index");
        } else {
            expect($b->{run_type} eq 'aggregate', "$name: run_type");
            expect($name eq "$b->{run_name}_$b->{aggregate_name}", "$name: aggregate_name");
            expect(scalar($b->{aggregate_unit} =~ /^(time|percentage)$/), "$name: aggregate_unit");
            expect(!exists $b->{repetition_index}, "$name: repetition_index");
            $aggregates{ $b->{run_name} }{ $b->{aggregate_name} } = $b;
        }
    }
    for (keys %runs) {
        expect(@{ $runs{$_} } == 3, "$_: runs");
        expect(keys_of($aggregates{$_}) eq 'cv mean median stddev', "$_: aggregates");
    }
    my $one = 'trace/scene:balls_high/variant:bvh/threads:1/bounce:0';
    expect(join(' ', map { $_->{real_time} } @{ $runs{$one} }) eq '100 102 104', 'times');
    expect($aggregates{$one}{median}{real_time} == 102, 'median');
    expect($aggregates{$one}{stddev}{cpu_time} == 2, 'stddev');
    expect($runs{$one}[0]{rays} == 1000 && $runs{$one}[0]{'Mrays/s'} == 10, 'counters');
    expect($runs{$one}[0]{iterations} == 2000, 'iterations');
    my $two = 'trace/scene:balls_high/variant:packet+omp/threads:2/bounce:0';
    expect($runs{$two}[0]{real_time} == 25 && $runs{$two}[0]{cpu_time} == 50, 'wall and work');
    expect($runs{'build/scene:balls_high/variant:bvh/threads:1'}[2]{real_time} == 7002, 'build');
    expect(!scalar(grep { /broken|neon|shade/ } keys %runs), 'what has no time');
}

sub hyperfine {
    my @results = @{ $data->{results} };
    expect(keys_of($data) eq 'results' && @results == 3, 'three results');
    for my $r (@results) {
        expect(keys_of($r) eq 'command exit_codes max mean median min parameters stddev system'
            . ' times user', 'members');
        expect(is_number($r->{$_}), $_) for qw(mean stddev median min max);
        expect(@{ $r->{times} } == 6 && @{ $r->{exit_codes} } == 6, 'six frames');
        expect(!scalar(grep { $_ ne '0' } @{ $r->{exit_codes} }), 'exit codes');
        expect(!defined $r->{user} && !defined $r->{system}, 'user and system are not measured');
    }
    my $first = $results[0];
    expect($first->{min} == 0.0004 && $first->{max} == 0.0004025, 'seconds');
    expect(abs($first->{mean} - 0.00040125) < 1e-9 && $first->{times}[1] == 0.0004005, 'mean');
    expect($first->{parameters}{variant} eq 'bvh', 'parameters');
    expect($results[2]{parameters}{scene} eq 'my "scenes"/a, b.nff', 'a scene with quotes');
}

$kind eq 'google' ? google() : hyperfine();
