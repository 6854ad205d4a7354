import java.io.File;
import java.util.Arrays;
import java.util.stream.Collectors;
import no.ntnu.ihb.fmi4j.importer.fmi2.CoSimulationSlave;
import no.ntnu.ihb.fmi4j.importer.fmi2.Fmu;

/**
 * Simulates an FMU in FMI4j: Simulate FMU STEP COUNT REFERENCE...
 *
 * <p>Prints the Real outputs, one line before the first step and one after each.
 */
public class Simulate {
    public static void main(String[] args) throws Exception {
        double step = Double.parseDouble(args[1]);
        int count = Integer.parseInt(args[2]);
        long[] references = Arrays.stream(args).skip(3).mapToLong(Long::parseLong).toArray();
        double[] values = new double[references.length];
        try (Fmu fmu = Fmu.from(new File(args[0]))) {
            CoSimulationSlave slave = fmu.asCoSimulationFmu().newInstance("slave");
            check(slave.setupExperiment(), "setupExperiment");
            check(slave.enterInitializationMode(), "enterInitializationMode");
            check(slave.exitInitializationMode(), "exitInitializationMode");
            for (int k = 0; k <= count; k++) {
                if (k > 0) {
                    check(slave.doStep((k - 1) * step, step), "doStep");
                }
                slave.readReal(references, values);
                System.out.println(
                        Arrays.stream(values).mapToObj(Double::toString).collect(Collectors.joining(" ")));
            }
            check(slave.terminate(), "terminate");
            slave.close();
        }
    }

    private static void check(boolean succeeded, String call) {
        if (!succeeded) {
            throw new IllegalStateException(call + " failed");
        }
    }
}
